#include "judge.h"

#include <math.h>

#include "exact_ray_triangle.h"

hpt_verdict hpt_judge_ray_triangle(const float ray[6], const float triangle[9], const hp_result *answer) {
    hpt_crossing exact = hpt_exact_ray_triangle(ray, triangle);
    hpt_verdict verdict = {.right = exact.F == (answer->F != 0), .measured = answer->F && exact.crosses};
    if (verdict.right && !verdict.measured) return verdict;
    hpt_ray_triangle_scale scale = hpt_scale_ray_triangle(ray, triangle);
    if (!verdict.right) {
        verdict.margin = fabs(hpt_margin_ray_triangle(ray, triangle)) / hpt_band(&scale);
        verdict.within = verdict.margin <= 1;
    }
    if (verdict.measured) {
        verdict.T_error = hpt_T_error(&exact, &scale, answer->T);
        verdict.CP_error = hpt_CP_error(&exact, &scale, answer->CP);
    }
    return verdict;
}

void hpt_tally_add(hpt_tally *tally, const hp_result *answer, const hpt_verdict *verdict) {
    tally->count++;
    tally->hits += answer->F;
    tally->within += !verdict->right && verdict->within;
    tally->outside += !verdict->right && !verdict->within;
    tally->worst_T = fmax(tally->worst_T, verdict->T_error);
    tally->worst_CP = fmax(tally->worst_CP, verdict->CP_error);
    tally->worst_margin = fmax(tally->worst_margin, verdict->margin);
}
