#include "judge.h"

#include <math.h>

/* A NaN is as wrong as can be. Two points in the origin have no scale: there is no error to be had but an infinite
 * one.
 */
static double error_of(double given, double exact, double scale) {
    double error = given == exact ? 0 : fabs(given - exact) / scale;
    return error >= 0 ? error : INFINITY;
}

static double distance(const double a[3], const double b[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++) square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square) >= 0 ? sqrt(square) : INFINITY;
}

static bool is_finite(const double a[3]) {
    return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

static void measure_ray(hpt_verdict *verdict, const hpt_truth *truth, const hpt_given *given, double scale) {
    verdict->measured = truth->crosses;
    if (!verdict->measured) return;
    verdict->T_error = error_of(given->T, truth->t, scale / (truth->length * truth->cosine));
    verdict->CP_error = distance(given->CP, truth->CP) * truth->cosine / scale;
}

static void measure_depth(hpt_verdict *verdict, hp_pair pair, const float *primary, const float *secondary,
                          const hpt_truth *truth, const hpt_given *given, double scale) {
    verdict->measured = true;
    verdict->T_error = error_of(given->T, -truth->signed_distance, scale);
    verdict->CP_error = INFINITY;
    if (!is_finite(given->CP)) return;
    double off = fmax(hpt_distance_to(hp_pair_primary(pair), primary, given->CP),
                      hpt_distance_to(hp_pair_secondary(pair), secondary, given->CP));
    verdict->CP_error = error_of(off, 0, scale);
}

hpt_verdict hpt_judge(hp_pair pair, const float *primary, const float *secondary, const hpt_truth *truth,
                      bool separation, const hpt_given *given) {
    bool is_ray = hp_pair_primary(pair) == HP_RAY;
    double scale = fmax(truth->L, truth->C);
    hpt_verdict verdict = {.right = truth->F == given->F};
    if (!verdict.right) {
        verdict.margin = fabs(truth->signed_distance) / truth->band;
        verdict.within = verdict.margin <= 1;
    }
    if (!verdict.right && !verdict.within && !is_ray) return verdict;
    if (given->F && is_ray)
        measure_ray(&verdict, truth, given, scale);
    else if (given->F)
        measure_depth(&verdict, pair, primary, secondary, truth, given, scale);
    verdict.separated = !given->F && separation && (verdict.right || verdict.within);
    if (verdict.separated) {
        double exact = is_ray ? fmax(0, truth->signed_distance) : truth->signed_distance;
        verdict.separation_error = error_of(given->T, exact, scale);
    }
    return verdict;
}

hpt_verdict hpt_judge_result(hp_pair pair, const float *primary, const float *secondary, const hp_result *answer) {
    hpt_truth truth = hpt_truth_of(pair, primary, secondary);
    hpt_given given = {answer->F != 0, answer->T, {answer->CP[0], answer->CP[1], answer->CP[2]}};
    return hpt_judge(pair, primary, secondary, &truth, false, &given);
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
