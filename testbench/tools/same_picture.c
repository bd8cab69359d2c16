/* same_picture A.png B.png LEVELS: whether two pictures are the same but for so many of the 255 levels.
 *
 * When A is N times as wide and high as B, the mean of each N x N pixels of A is compared with a pixel of B, and the
 * mean of all differences counts; otherwise the greatest. Exit status 0, 1 when they differ, 2 for bad files. */
#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint8_t *read_picture(const char *path, png_image *image) {
    *image = (png_image){.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(image, path)) return NULL;
    image->format = PNG_FORMAT_RGB;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(*image));
    if (rgb && !png_image_finish_read(image, NULL, rgb, 0, NULL)) free(rgb), rgb = NULL;
    return rgb;
}

/* The mean of n x n pixels of `rgb` at pixel (x, y) of the smaller picture. */
static double mean(const uint8_t *rgb, size_t width, size_t n, size_t x, size_t y, size_t channel) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) sum += rgb[3 * ((y * n + i) * width + x * n + k) + channel];
    return sum / (double)(n * n);
}

int main(int argc, char **argv) {
    png_image a, b;
    uint8_t *large = argc == 4 ? read_picture(argv[1], &a) : NULL, *small = large ? read_picture(argv[2], &b) : NULL;
    if (!small) return fprintf(stderr, "usage: same_picture A.png B.png LEVELS\n"), 2;
    size_t n = a.width / b.width;
    double greatest = 0, sum = 0, count = 3.0 * b.width * b.height;
    bool fits = n > 0 && a.width == n * b.width && a.height == n * b.height;
    for (size_t i = 0; fits && i < (size_t)count; i++) {
        size_t x = i / 3 % b.width, y = i / 3 / b.width;
        double difference = fabs(mean(large, a.width, n, x, y, i % 3) - small[i]);
        greatest = fmax(greatest, difference);
        sum += difference;
    }
    double found = n > 1 ? sum / count : greatest;
    if (!fits)
        fprintf(stderr, "%s, %s: %ux%u and %ux%u pixels\n", argv[1], argv[2], a.width, a.height, b.width, b.height);
    else
        printf("%s, %s: %.3g levels apart\n", argv[1], argv[2], found);
    free(large);
    free(small);
    return fits && found <= atof(argv[3]) ? 0 : 1;
}
