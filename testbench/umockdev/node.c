/* Device nodes: FIFOs in the directory that umockdev shows as /dev, for what poll(2) sees, and sockets of umockdev's,
 * on which ioctls come. A node of each time that the device is plugged in: those of before stay until they are
 * closed. */
#include "mock.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PAGE = 4096 };

static hpt_node *nodes;

/* ---- who has it open ---- */

static hpt_client *client_of(hpt_node *node, const UMockdevIoctlClient *connection) {
    hpt_client *at = node->clients;
    while (at && at->connection != connection) at = at->next;
    return at;
}

/* umockdev drops a connection once it is closed: nothing else tells of it. */
static void on_closed(gpointer context, GObject *connection) {
    hpt_node *node = context;
    pthread_mutex_lock(&hpt_lock);
    for (hpt_client **at = &node->clients; *at; at = &(*at)->next) {
        hpt_client *client = *at;
        if ((GObject *)client->connection != connection) continue;
        *at = client->next;
        node->kind->closed(client);
        free(client);
        break;
    }
    pthread_mutex_unlock(&hpt_lock);
}

static void on_opened(UMockdevIoctlBase *base, UMockdevIoctlClient *connection, gpointer context) {
    hpt_node *node = context;
    (void)base;
    pthread_mutex_lock(&hpt_lock);
    hpt_client *client = calloc(1, sizeof *client);
    if (!client) abort();
    *client = (hpt_client){.node = node, .connection = connection, .next = node->clients};
    node->clients = client;
    g_object_weak_ref(G_OBJECT(connection), on_closed, node);
    node->kind->opened(client);
    pthread_mutex_unlock(&hpt_lock);
}

/* ---- ioctls ---- */

static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *connection, gpointer context) {
    hpt_node *node = context;
    (void)base;
    pthread_mutex_lock(&hpt_lock);
    hpt_client *client = client_of(node, connection);
    if (!client) abort();
    int result = node->kind->answer(client, umockdev_ioctl_client_get_request(connection),
                                    umockdev_ioctl_client_get_arg(connection));
    umockdev_ioctl_client_complete(connection, result < 0 ? -1 : result, result < 0 ? -result : 0);
    pthread_mutex_unlock(&hpt_lock);
    return TRUE;
}

/* Reports are read from the FIFO; what is gone gives an error, as hidraw does. */
static gboolean on_read(UMockdevIoctlBase *base, UMockdevIoctlClient *connection, gpointer context) {
    hpt_node *node = context;
    (void)base;
    pthread_mutex_lock(&hpt_lock);
    bool gone = node->gone;
    pthread_mutex_unlock(&hpt_lock);
    if (gone) umockdev_ioctl_client_complete(connection, -1, EIO);
    return gone;
}

/* ---- the FIFO ---- */

static void make_directories(char *path) {
    for (char *at = strchr(path + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = '\0';
        if (mkdir(path, 0755) && errno != EEXIST) abort();
        *at = '/';
    }
}

static void real_path(const hpt_node *node, char *path, size_t room) {
    snprintf(path, room, "%s%s", hpt_mock_root(), node->path);
}

/* With O_DIRECT, which open does not take, a FIFO keeps what is written apart: a report is read as it was sent. */
static void make_fifo(hpt_node *node, unsigned mode) {
    char path[256];
    unsigned slots = node->kind->slots;
    real_path(node, path, sizeof path);
    make_directories(path);
    if (mkfifo(path, 0600)) abort();
    node->fifo = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (node->fifo < 0 || fcntl(node->fifo, F_SETFL, O_NONBLOCK | (slots ? O_DIRECT : 0)) ||
        fcntl(node->fifo, F_SETPIPE_SZ, slots ? slots * PAGE : PAGE) < 0)
        abort();
    if (chmod(path, mode)) abort();
    if (!slots) hpt_node_show(node, false);
}

/* One byte makes the FIFO of one page full. */
void hpt_node_show(hpt_node *node, bool ready) {
    char byte = 0;
    if (node->full == !ready) return;
    node->full = !ready;
    if ((ready ? read(node->fifo, &byte, 1) : write(node->fifo, &byte, 1)) != 1) abort();
}

void hpt_node_report(hpt_node *node, const uint8_t *bytes, size_t n) {
    if (write(node->fifo, bytes, n) != (ssize_t)n && errno != EAGAIN) abort();
}

void hpt_node_drain(hpt_node *node) {
    uint8_t bytes[PAGE];
    while (read(node->fifo, bytes, sizeof bytes) > 0) continue;
}

/* ---- coming and going ---- */

/* The handler is attached before anybody can see the node. */
hpt_node *hpt_node_new(const char *path, const hpt_node_kind *kind, hpt_device *device, unsigned mode) {
    hpt_node *node = calloc(1, sizeof *node);
    if (!node) abort();
    *node = (hpt_node){.kind = kind, .device = device, .next = nodes};
    snprintf(node->path, sizeof node->path, "%s", path);
    nodes = node;
    node->base = umockdev_ioctl_base_new();
    g_signal_connect(node->base, "client-connected", G_CALLBACK(on_opened), node);
    g_signal_connect(node->base, "handle-ioctl", G_CALLBACK(on_ioctl), node);
    g_signal_connect(node->base, "handle-read", G_CALLBACK(on_read), node);
    if (!umockdev_testbed_attach_ioctl(hpt_mock_testbed(), path, node->base, NULL)) abort();
    make_fifo(node, mode);
    return node;
}

void hpt_node_remove(hpt_node *node) {
    char path[256];
    real_path(node, path, sizeof path);
    if (unlink(path)) abort();
    if (!umockdev_testbed_detach_ioctl(hpt_mock_testbed(), node->path, NULL)) abort();
    node->gone = true;
    if (node->kind->slots) hpt_node_report(node, (const uint8_t *)"", 1); /* who waits looks again */
}

unsigned hpt_nodes_open(void) {
    unsigned count = 0;
    for (const hpt_node *node = nodes; node; node = node->next)
        for (const hpt_client *client = node->clients; client; client = client->next) count++;
    return count;
}

void hpt_nodes_free(void) {
    for (hpt_node *node; (node = nodes);) {
        nodes = node->next;
        if (node->clients || !node->gone) abort();
        close(node->fifo);
        g_object_unref(node->base);
        free(node);
    }
}
