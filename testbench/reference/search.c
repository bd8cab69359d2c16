#define HPT_SEARCH_TEXT "search_body.h"
#include "search_numbers.h"

void hpt_search_in_double(const hpt_body *body, double scale, hpt_search *found) {
    in_double_search(body, scale, found);
}

void hpt_search_in_quad(const hpt_body *body, double scale, hpt_search *found) {
    in_quad_search(body, scale, found);
}

double hpt_search_nearest(const hpt_body *body, double scale) {
    in_double_body scaled;
    in_double_simplex simplex;
    double direction[3];
    in_double_read_body(body, scale, &scaled);
    in_double_find_nearest(&scaled, &simplex, direction);
    return simplex.length;
}
