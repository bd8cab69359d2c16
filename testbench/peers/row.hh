/* Makes a row of a library's list out of two object classes and a function that tests one pair. The loops are here,
 * so that the call of that function is inlined into them: nothing stands between loop and library. */
#ifndef TESTBENCH_PEERS_ROW_HH
#define TESTBENCH_PEERS_ROW_HH

#include "testbench/peers/peer.h"

#include <cmath>
#include <utility>
#include <vector>

namespace peers {

constexpr double unsaid = NAN;

inline peer_answer answer(bool F, double T = unsaid) {
    return {F, false, T};
}

inline const peer_answer cannot_tell = {false, true, unsaid};

/* A class of objects says how many words it is made of: Object::words. */
template <class Object> void *make(const float *words, size_t n) {
    auto *objects = new std::vector<Object>;
    objects->reserve(n);
    for (size_t i = 0; i < n; i++) objects->emplace_back(words + i * Object::words);
    return objects;
}

template <class Object> void drop(void *objects) {
    delete static_cast<std::vector<Object> *>(objects);
}

template <class Object> const Object *objects_of(const void *objects) {
    return static_cast<const std::vector<Object> *>(objects)->data();
}

template <class Primary, class Secondary, peer_answer (*test)(const Primary &, const Secondary &)>
void zip(const void *primaries, const void *secondaries, size_t n, peer_answer *answers) {
    const Primary *p = objects_of<Primary>(primaries);
    const Secondary *s = objects_of<Secondary>(secondaries);
    for (size_t i = 0; i < n; i++) answers[i] = test(p[i], s[i]);
}

template <class Primary, class Secondary, peer_answer (*test)(const Primary &, const Secondary &)>
size_t all(const void *primaries, size_t n, const void *secondaries, size_t m) {
    const Primary *p = objects_of<Primary>(primaries);
    const Secondary *s = objects_of<Secondary>(secondaries);
    size_t hits = 0;
    double deepest = 0; /* T is asked for, as closest does; so no compiler may drop it */
    for (size_t j = 0; j < m; j++)
        for (size_t i = 0; i < n; i++) {
            peer_answer a = test(p[i], s[j]);
            hits += a.F;
            if (a.T > deepest) deepest = a.T;
        }
    volatile double kept = deepest;
    (void)kept;
    return hits;
}

enum says { F_only, depth, distance, both };

template <class Primary, class Secondary, peer_answer (*test)(const Primary &, const Secondary &)>
peer row(hp_pair pair, const char *library, const char *function, says T, const char *answers = "") {
    return {pair,
            library,
            function,
            answers,
            T == depth || T == both,
            T == distance || T == both,
            make<Primary>,
            make<Secondary>,
            drop<Primary>,
            drop<Secondary>,
            zip<Primary, Secondary, test>,
            all<Primary, Secondary, test>};
}

/* ---- what the libraries' objects have in common ---- */

struct point {
    double x, y, z;
};

inline point point_of(const float *w) {
    return {w[0], w[1], w[2]};
}

inline point operator-(point a, point b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline point operator+(point a, point b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline point operator*(double s, point a) {
    return {s * a.x, s * a.y, s * a.z};
}

inline double dot(point a, point b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline point cross(point a, point b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double length(point a) {
    return std::sqrt(dot(a, a));
}

inline point unit(point a) {
    return 1 / length(a) * a;
}

/* A box of either kind: centre, half extents, axes of the right hand. hitpipe takes either hand; libraries that keep
 * a frame as a quaternion cannot. The box is the same with its third axis turned round. */
struct box_words {
    point centre, half, axis[3];
};

inline box_words box_of_obb(const float *w) {
    point u = point_of(w + 6), v = point_of(w + 9), third = point_of(w + 12);
    return {point_of(w), point_of(w + 3), {u, v, dot(cross(u, v), third) < 0 ? -1 * third : third}};
}

inline box_words box_of_aabb(const float *w) {
    point low = point_of(w), high = point_of(w + 3);
    return {0.5 * (low + high), 0.5 * (high - low), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/* A cylinder as the libraries want it: middle, length, radius, and a frame whose third axis is its own. */
struct cylinder_words {
    point centre, frame[3];
    double length, radius;
};

inline cylinder_words cylinder_of(const float *w) {
    point p0 = point_of(w), p1 = point_of(w + 3), along = p1 - p0, axis = unit(along);
    point other = std::fabs(axis.x) < 0.6 ? point{1, 0, 0} : point{0, 1, 0};
    point first = unit(cross(other, axis));
    return {0.5 * (p0 + p1), {first, cross(axis, first), axis}, length(along), w[6]};
}

/* A ray as a segment, which is what most libraries call a ray: as far as anything in the scenes of this room. */
constexpr double reach = 1000;

struct ray_words {
    point origin, direction; /* of length 1 */
    double scale;            /* lengths of hitpipe's direction in a length */
};

inline ray_words ray_of(const float *w) {
    point direction = point_of(w + 3);
    double scale = 1 / length(direction);
    return {point_of(w), scale * direction, scale};
}

} // namespace peers
#endif
