/* libccd, in double: GJK with EPA and Minkowski portal refinement over support functions, which its user writes:
 * those below. Rays are segments, which GJK tells to meet or not to meet; a plane is not convex and bounded, hence
 * absent. */
#include "testbench/peers/row.hh"

#include <ccd/ccd.h>

using namespace peers;

namespace {

void put(point a, ccd_vec3_t *v) {
    ccdVec3Set(v, a.x, a.y, a.z);
}

point got(const ccd_vec3_t *v) {
    return {v->v[0], v->v[1], v->v[2]};
}

/* ---- objects with their support functions and a point within ---- */

struct sphere {
    static constexpr size_t words = HP_SPHERE_WORDS;
    point centre;
    double radius;
    sphere(const float *w) : centre(point_of(w)), radius(w[3]) {}
    point support(point d) const {
        double size = length(d);
        return size > 0 ? centre + radius / size * d : centre;
    }
};

struct box {
    point centre, edge[3]; /* half an edge along each axis */
    box(const box_words &b)
        : centre(b.centre), edge{b.half.x * b.axis[0], b.half.y * b.axis[1], b.half.z * b.axis[2]} {}
    point support(point d) const {
        point s = centre;
        for (const point &e : edge) s = s + std::copysign(1.0, dot(e, d)) * e;
        return s;
    }
};

struct obb : box {
    static constexpr size_t words = HP_OBB_WORDS;
    obb(const float *w) : box(box_of_obb(w)) {}
};

struct aabb {
    static constexpr size_t words = HP_AABB_WORDS;
    point centre, half;
    aabb(const float *w) : centre(box_of_aabb(w).centre), half(box_of_aabb(w).half) {}
    point support(point d) const {
        return centre + point{std::copysign(half.x, d.x), std::copysign(half.y, d.y), std::copysign(half.z, d.z)};
    }
};

struct cylinder {
    static constexpr size_t words = HP_CYLINDER_WORDS;
    point centre, axis;
    double half, radius;
    cylinder(const float *w) {
        cylinder_words c = cylinder_of(w);
        centre = c.centre, axis = c.frame[2], half = c.length / 2, radius = c.radius;
    }
    point support(point d) const {
        double along = dot(axis, d);
        point across = d - along * axis;
        double wide = dot(across, across);
        point s = centre + std::copysign(half, along) * axis;
        return wide > 0 ? s + radius / std::sqrt(wide) * across : s;
    }
};

struct triangle {
    static constexpr size_t words = HP_TRIANGLE_WORDS;
    point corner[3], centre;
    triangle(const float *w) : corner{point_of(w), point_of(w + 3), point_of(w + 6)} {
        centre = 1.0 / 3 * (corner[0] + corner[1] + corner[2]);
    }
    point support(point d) const {
        double a = dot(corner[0], d), b = dot(corner[1], d), c = dot(corner[2], d);
        return a > b ? (a > c ? corner[0] : corner[2]) : (b > c ? corner[1] : corner[2]);
    }
};

struct ray {
    static constexpr size_t words = HP_RAY_WORDS;
    point origin, end, centre;
    ray(const float *w) {
        ray_words r = ray_of(w);
        origin = r.origin, end = r.origin + reach * r.direction, centre = 0.5 * (origin + end);
    }
    point support(point d) const { return dot(end - origin, d) > 0 ? end : origin; }
};

/* ---- tests ---- */

template <class Object> void support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *furthest) {
    put(static_cast<const Object *>(object)->support(got(direction)), furthest);
}

template <class Object> void centre(const void *object, ccd_vec3_t *middle) {
    put(static_cast<const Object *>(object)->centre, middle);
}

template <class A, class B> ccd_t settings() {
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = support<A>;
    ccd.support2 = support<B>;
    ccd.center1 = centre<A>;
    ccd.center2 = centre<B>;
    ccd.max_iterations = 100;
    return ccd;
}

template <class A, class B> const ccd_t set = settings<A, B>();

template <class A, class B> peer_answer gjk(const A &a, const B &b) {
    return answer(ccdGJKIntersect(&a, &b, &set<A, B>));
}

template <class A, class B> peer_answer mpr(const A &a, const B &b) {
    return answer(ccdMPRIntersect(&a, &b, &set<A, B>));
}

template <class A, class B> peer_answer gjk_depth(const A &a, const B &b) {
    double T = unsaid;
    ccd_vec3_t direction, position;
    int status = ccdGJKPenetration(&a, &b, &set<A, B>, &T, &direction, &position);
    return status == -2 ? cannot_tell : answer(status == 0, status == 0 ? T : unsaid);
}

template <class A, class B> peer_answer mpr_depth(const A &a, const B &b) {
    double T = unsaid;
    ccd_vec3_t direction, position;
    bool F = ccdMPRPenetration(&a, &b, &set<A, B>, &T, &direction, &position) == 0;
    return answer(F, F ? T : unsaid);
}

/* ---- rows ---- */

template <class A, class B> void add(std::vector<peer> &rows, hp_pair pair) {
    rows.push_back(row<A, B, mpr<A, B>>(pair, "libccd", "MPR, F only", F_only));
    rows.push_back(row<A, B, gjk<A, B>>(pair, "libccd", "GJK, F only", F_only));
    rows.push_back(row<A, B, mpr_depth<A, B>>(pair, "libccd", "MPR, depth", depth, "depth along one direction"));
    rows.push_back(row<A, B, gjk_depth<A, B>>(pair, "libccd", "GJK, EPA", depth));
}

template <class B> void add_ray(std::vector<peer> &rows, hp_pair pair) {
    rows.push_back(row<ray, B, gjk<ray, B>>(pair, "libccd", "GJK, F only", F_only, "a segment"));
    rows.push_back(row<ray, B, mpr<ray, B>>(pair, "libccd", "MPR, F only", F_only, "a segment"));
}

std::vector<peer> make_rows() {
    std::vector<peer> rows;
    add<obb, obb>(rows, HP_PAIR_OBB_OBB);
    add<triangle, aabb>(rows, HP_PAIR_TRIANGLE_AABB);
    add<triangle, obb>(rows, HP_PAIR_TRIANGLE_OBB);
    add<sphere, sphere>(rows, HP_PAIR_SPHERE_SPHERE);
    add<triangle, sphere>(rows, HP_PAIR_TRIANGLE_SPHERE);
    add<triangle, cylinder>(rows, HP_PAIR_TRIANGLE_CYLINDER);
    add<cylinder, cylinder>(rows, HP_PAIR_CYLINDER_CYLINDER);
    add<obb, cylinder>(rows, HP_PAIR_OBB_CYLINDER);
    add<sphere, obb>(rows, HP_PAIR_SPHERE_OBB);
    add_ray<triangle>(rows, HP_PAIR_RAY_TRIANGLE);
    add_ray<cylinder>(rows, HP_PAIR_RAY_CYLINDER);
    add_ray<sphere>(rows, HP_PAIR_RAY_SPHERE);
    return rows;
}

} // namespace

peer_list peers_ccd(void) {
    static const std::vector<peer> rows = make_rows();
    return {rows.data(), rows.size()};
}
