#include "exact_vector.h"

void hpt_q3_init(hpt_q3 *a) {
    for (int i = 0; i < 3; i++) mpq_init(a->of[i]);
}

void hpt_q3_clear(hpt_q3 *a) {
    for (int i = 0; i < 3; i++) mpq_clear(a->of[i]);
}

void hpt_q3_read(hpt_q3 *a, const float *xyz) {
    for (int i = 0; i < 3; i++) mpq_set_d(a->of[i], (double)xyz[i]);
}

void hpt_q3_set(hpt_q3 *to, const hpt_q3 *from) {
    for (int i = 0; i < 3; i++) mpq_set(to->of[i], from->of[i]);
}

void hpt_q3_sub(hpt_q3 *to, const hpt_q3 *a, const hpt_q3 *b) {
    for (int i = 0; i < 3; i++) mpq_sub(to->of[i], a->of[i], b->of[i]);
}

void hpt_q3_add_scaled(hpt_q3 *to, const hpt_q3 *a, const mpq_t k, const hpt_q3 *b) {
    mpq_t product;
    mpq_init(product);
    for (int i = 0; i < 3; i++) {
        mpq_mul(product, k, b->of[i]);
        mpq_add(to->of[i], a->of[i], product);
    }
    mpq_clear(product);
}

void hpt_q3_cross(hpt_q3 *to, const hpt_q3 *a, const hpt_q3 *b) {
    mpq_t product;
    mpq_init(product);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(to->of[i], a->of[j], b->of[k]);
        mpq_mul(product, a->of[k], b->of[j]);
        mpq_sub(to->of[i], to->of[i], product);
    }
    mpq_clear(product);
}

void hpt_q3_dot(mpq_t to, const hpt_q3 *a, const hpt_q3 *b) {
    mpq_t sum, product;
    mpq_inits(sum, product, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_mul(product, a->of[i], b->of[i]);
        mpq_add(sum, sum, product);
    }
    mpq_set(to, sum);
    mpq_clears(sum, product, NULL);
}
