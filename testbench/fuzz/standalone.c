/* Runs a fuzzer over files kept in directories, without a fuzzing compiler: fuzz_NAME DIRECTORY... Ends with
 * 'N files'; a crash is the failure. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { FILE_MOST = 1 << 20 };

static int run_file(const char *path) {
    FILE *file = fopen(path, "rb");
    uint8_t *data = malloc(FILE_MOST);
    if (!file || !data) {
        perror(path);
        exit(2);
    }
    size_t n = fread(data, 1, FILE_MOST, file);
    fclose(file);
    data = realloc(data, n ? n : 1); /* so that a sanitizer sees a read past the end */
    LLVMFuzzerTestOneInput(data, n);
    free(data);
    return 1;
}

static int run_directory(const char *directory) {
    DIR *listing = opendir(directory);
    struct dirent *entry;
    char path[4096];
    int files = 0;
    if (!listing) {
        perror(directory);
        exit(2);
    }
    while ((entry = readdir(listing))) {
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
        files += run_file(path);
    }
    closedir(listing);
    return files;
}

int main(int argc, char **argv) {
    int files = 0;
    for (int i = 1; i < argc; i++) files += run_directory(argv[i]);
    printf("%d files\n", files);
    return files == 0;
}
