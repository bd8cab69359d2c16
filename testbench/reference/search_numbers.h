/* The two number types of the search: in_double_ and in_quad_ before every name of search_vector.h. Before this a
 * file says with HPT_SEARCH_TEXT what to include under each. Private to the reference; no include guard. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "search.h"

/* In units of the body's size: what a search is content with, and what it takes for flat. */
#define HPT_TOLERANCE ((REAL)2e-10)
#define HPT_THIN ((REAL)1e-10)

#define HPT_PASTE_(a, b) a##_##b
#define HPT_PASTE(a, b) HPT_PASTE_(a, b)
#define HPT_NAMED(word) HPT_PASTE(HPT_TYPE, word)
#define HPT_LOCAL __attribute__((unused)) static

HPT_LOCAL double in_double_root(double square) {
    return sqrt(square);
}

HPT_LOCAL hp_quad in_quad_root(hp_quad square) {
    return hpt_root(square);
}

/* HPT_EPSILON: some units in the last place of 1. */
#define HPT_TYPE in_double
#define REAL double
#define HPT_EPSILON 2e-15
#include HPT_SEARCH_TEXT
#undef HPT_TYPE
#undef REAL
#undef HPT_EPSILON

#define HPT_TYPE in_quad
#define REAL hp_quad
#define HPT_EPSILON ((hp_quad)1e-31)
#include HPT_SEARCH_TEXT
