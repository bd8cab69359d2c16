#include "host/rays/angle.h"

/* Taylor's series, |x| <= pi / 2: the first term left out is below 1e-19. */
static double series(double x) {
    double sum = 0, term = x;
    for (int n = 1; n < 26; n += 2) {
        sum += term;
        term = -term * x * x / ((n + 1) * (n + 2));
    }
    return sum;
}

double hp_sine(double degrees) {
    const double pi = 3.14159265358979323846;
    while (degrees > 180) degrees -= 360;
    while (degrees < -180) degrees += 360;
    if (degrees > 90) degrees = 180 - degrees;
    if (degrees < -90) degrees = -180 - degrees;
    return series(degrees * (pi / 180));
}

double hp_cosine(double degrees) {
    return hp_sine(90 - degrees);
}

double hp_tangent(double degrees) {
    return hp_sine(degrees) / hp_cosine(degrees);
}
