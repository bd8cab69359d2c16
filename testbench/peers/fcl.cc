/* FCL 0.7, in double: its separating axes for boxes, its own solvers for pairs with spheres and planes, libccd's GJK
 * and EPA or its own for the rest. It knows no ray. */
#include "testbench/peers/row.hh"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/detail/failed_at_this_configuration.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/box_box.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/halfspace.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/plane.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/sphere_box.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/sphere_sphere.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/sphere_triangle.h>

using namespace peers;

namespace {

using vector = fcl::Vector3d;
using transform = fcl::Transform3d;

vector vector_of(point a) {
    return {a.x, a.y, a.z};
}

transform placed(point centre, const point frame[3]) {
    transform t = transform::Identity();
    for (int axis = 0; axis < 3; axis++) t.linear().col(axis) = vector_of(frame[axis]);
    t.translation() = vector_of(centre);
    return t;
}

transform moved(point centre) {
    transform t = transform::Identity();
    t.translation() = vector_of(centre);
    return t;
}

/* ---- objects ---- */

struct sphere {
    static constexpr size_t words = HP_SPHERE_WORDS;
    transform at;
    fcl::Sphered shape;
    sphere(const float *w) : at(moved(point_of(w))), shape(w[3]) {}
};

struct box {
    transform at;
    fcl::Boxd shape;
    box(const box_words &b) : at(placed(b.centre, b.axis)), shape(2 * b.half.x, 2 * b.half.y, 2 * b.half.z) {}
};

struct obb : box {
    static constexpr size_t words = HP_OBB_WORDS;
    obb(const float *w) : box(box_of_obb(w)) {}
};

struct aabb : box {
    static constexpr size_t words = HP_AABB_WORDS;
    aabb(const float *w) : box(box_of_aabb(w)) {}
};

struct bounding_box {
    static constexpr size_t words = HP_OBB_WORDS;
    fcl::OBBd shape;
    bounding_box(const float *w) {
        box_words b = box_of_obb(w);
        for (int axis = 0; axis < 3; axis++) shape.axis.col(axis) = vector_of(b.axis[axis]);
        shape.To = vector_of(b.centre);
        shape.extent = vector_of(b.half);
    }
};

struct cylinder {
    static constexpr size_t words = HP_CYLINDER_WORDS;
    transform at;
    fcl::Cylinderd shape;
    cylinder(const float *w) : cylinder(cylinder_of(w)) {}
    cylinder(const cylinder_words &c) : at(placed(c.centre, c.frame)), shape(c.radius, c.length) {}
};

struct triangle {
    static constexpr size_t words = HP_TRIANGLE_WORDS;
    vector a, b, c;
    triangle(const float *w) : a(w[0], w[1], w[2]), b(w[3], w[4], w[5]), c(w[6], w[7], w[8]) {}
};

const transform still = transform::Identity();

struct thin_plane {
    static constexpr size_t words = HP_PLANE_WORDS;
    fcl::Planed shape;
    thin_plane(const float *w) : shape(vector(w[0], w[1], w[2]), w[3]) {}
};

struct half_space {
    static constexpr size_t words = HP_PLANE_WORDS;
    fcl::Halfspaced shape;
    half_space(const float *w) : shape(vector(w[0], w[1], w[2]), w[3]) {}
};

/* ---- tests ---- */

const fcl::detail::GJKSolver_libccdd by_ccd;
const fcl::detail::GJKSolver_indepd by_itself;

using contacts = std::vector<fcl::ContactPointd>;

/* One vector kept: its memory is not what is compared. */
contacts &no_contacts() {
    static contacts kept;
    kept.clear();
    return kept;
}

peer_answer deepest_of(bool F, const contacts &found) {
    double T = F && found.empty() ? unsaid : 0;
    for (const auto &c : found) T = std::fmax(T, std::fabs(c.penetration_depth)); /* some solvers say -depth */
    return answer(F, F ? T : unsaid);
}

peer_answer separating_axes(const bounding_box &a, const bounding_box &b) {
    return answer(a.shape.overlap(b.shape));
}

peer_answer boxes(const obb &a, const obb &b) {
    contacts &found = no_contacts();
    bool F = fcl::detail::boxBoxIntersect(a.shape, a.at, b.shape, b.at, &found);
    return deepest_of(F, found);
}

peer_answer spheres(const sphere &a, const sphere &b) {
    contacts &found = no_contacts();
    bool F = fcl::detail::sphereSphereIntersect(a.shape, a.at, b.shape, b.at, &found);
    return deepest_of(F, found);
}

peer_answer spheres_apart(const sphere &a, const sphere &b) {
    double T = unsaid;
    bool apart = fcl::detail::sphereSphereDistance<double>(a.shape, a.at, b.shape, b.at, &T, nullptr, nullptr);
    return answer(!apart, apart ? T : unsaid);
}

peer_answer triangle_with_sphere(const triangle &t, const sphere &s) {
    double T = unsaid;
    bool F = fcl::detail::sphereTriangleIntersect<double>(s.shape, s.at, t.a, t.b, t.c, nullptr, &T, nullptr);
    return answer(F, F ? -T : unsaid); /* it says -depth */
}

peer_answer triangle_from_sphere(const triangle &t, const sphere &s) {
    double T = unsaid;
    bool apart = fcl::detail::sphereTriangleDistance<double>(s.shape, s.at, t.a, t.b, t.c, &T);
    return answer(!apart, apart ? T : unsaid);
}

peer_answer sphere_with_box(const sphere &s, const obb &b) {
    contacts &found = no_contacts();
    bool F = fcl::detail::sphereBoxIntersect(s.shape, s.at, b.shape, b.at, &found);
    return deepest_of(F, found);
}

peer_answer sphere_from_box(const sphere &s, const obb &b) {
    double T = unsaid;
    bool apart = fcl::detail::sphereBoxDistance<double>(s.shape, s.at, b.shape, b.at, &T, nullptr, nullptr);
    return answer(!apart, apart ? T : unsaid);
}

peer_answer box_with_plane(const obb &b, const thin_plane &p) {
    contacts &found = no_contacts();
    bool F = fcl::detail::boxPlaneIntersect(b.shape, b.at, p.shape, still, &found);
    return deepest_of(F, found);
}

peer_answer box_with_half_space(const obb &b, const half_space &h) {
    contacts &found = no_contacts();
    bool F = fcl::detail::boxHalfspaceIntersect(b.shape, b.at, h.shape, still, &found);
    return deepest_of(F, found);
}

peer_answer box_touches_half_space(const obb &b, const half_space &h) {
    return answer(fcl::detail::boxHalfspaceIntersect(b.shape, b.at, h.shape, still));
}

template <const auto &solver, class Object> peer_answer with_triangle(const triangle &t, const Object &o) try {
    double T = unsaid;
    vector position, normal;
    bool F = solver.shapeTriangleIntersect(o.shape, o.at, t.a, t.b, t.c, &position, &T, &normal);
    return answer(F, F ? std::fabs(T) : unsaid);
} catch (const fcl::detail::FailedAtThisConfiguration &) {
    return cannot_tell;
}

template <const auto &solver, class Object> peer_answer touches_triangle(const triangle &t, const Object &o) {
    return answer(solver.shapeTriangleIntersect(o.shape, o.at, t.a, t.b, t.c));
}

template <const auto &solver, class Object> peer_answer from_triangle(const triangle &t, const Object &o) try {
    double T = unsaid;
    bool apart = solver.shapeTriangleDistance(o.shape, o.at, t.a, t.b, t.c, &T);
    return answer(!apart, apart ? T : unsaid);
} catch (const fcl::detail::FailedAtThisConfiguration &) {
    return cannot_tell;
}

template <const auto &solver, class A, class B> peer_answer meet(const A &a, const B &b) try {
    contacts &found = no_contacts();
    bool F = solver.shapeIntersect(a.shape, a.at, b.shape, b.at, &found);
    return deepest_of(F, found);
} catch (const fcl::detail::FailedAtThisConfiguration &) {
    return cannot_tell;
}

template <const auto &solver, class A, class B> peer_answer touch(const A &a, const B &b) {
    return answer(solver.shapeIntersect(a.shape, a.at, b.shape, b.at, nullptr));
}

template <const auto &solver, class A, class B> peer_answer apart(const A &a, const B &b) try {
    double T = unsaid;
    bool far = solver.shapeDistance(a.shape, a.at, b.shape, b.at, &T);
    return answer(!far, far ? T : unsaid);
} catch (const fcl::detail::FailedAtThisConfiguration &) {
    return cannot_tell;
}

/* ---- rows ---- */

template <const auto &solver, class Object> void triangle_rows(std::vector<peer> &rows, hp_pair pair, bool ccd) {
    rows.push_back(row<triangle, Object, touches_triangle<solver, Object>>(
        pair, "FCL", ccd ? "MPR of libccd, F only" : "own GJK, F only", F_only));
    rows.push_back(row<triangle, Object, with_triangle<solver, Object>>(
        pair, "FCL", ccd ? "MPR of libccd, depth" : "own GJK, EPA", depth));
    rows.push_back(row<triangle, Object, from_triangle<solver, Object>>(
        pair, "FCL", ccd ? "distance by GJK of libccd" : "distance by own GJK", distance));
}

template <const auto &solver, class A, class B> void convex_rows(std::vector<peer> &rows, hp_pair pair, bool ccd) {
    rows.push_back(
        row<A, B, touch<solver, A, B>>(pair, "FCL", ccd ? "MPR of libccd, F only" : "own GJK, F only", F_only));
    rows.push_back(row<A, B, meet<solver, A, B>>(pair, "FCL", ccd ? "MPR of libccd, depth" : "own GJK, EPA", depth));
    rows.push_back(row<A, B, apart<solver, A, B>>(
        pair, "FCL", ccd ? "distance by GJK of libccd" : "distance by own GJK", distance));
}

template <const auto &solver> void solver_rows(std::vector<peer> &rows, bool ccd) {
    triangle_rows<solver, aabb>(rows, HP_PAIR_TRIANGLE_AABB, ccd);
    triangle_rows<solver, obb>(rows, HP_PAIR_TRIANGLE_OBB, ccd);
    triangle_rows<solver, cylinder>(rows, HP_PAIR_TRIANGLE_CYLINDER, ccd);
    convex_rows<solver, cylinder, cylinder>(rows, HP_PAIR_CYLINDER_CYLINDER, ccd);
    convex_rows<solver, obb, cylinder>(rows, HP_PAIR_OBB_CYLINDER, ccd);
}

std::vector<peer> make_rows() {
    std::vector<peer> rows = {
        row<bounding_box, bounding_box, separating_axes>(HP_PAIR_OBB_OBB, "FCL", "separating axes of OBB", F_only),
        row<obb, obb, boxes>(HP_PAIR_OBB_OBB, "FCL", "box-box", depth, "prefers faces to edges; makes contacts"),
        row<obb, obb, apart<by_ccd, obb, obb>>(HP_PAIR_OBB_OBB, "FCL", "distance by GJK of libccd", distance),
        row<sphere, sphere, spheres>(HP_PAIR_SPHERE_SPHERE, "FCL", "sphere-sphere", depth),
        row<sphere, sphere, spheres_apart>(HP_PAIR_SPHERE_SPHERE, "FCL", "sphere-sphere distance", distance),
        row<triangle, sphere, triangle_with_sphere>(HP_PAIR_TRIANGLE_SPHERE, "FCL", "sphere-triangle", depth),
        row<triangle, sphere, triangle_from_sphere>(HP_PAIR_TRIANGLE_SPHERE, "FCL", "sphere-triangle distance",
                                                    distance),
        row<sphere, obb, sphere_with_box>(HP_PAIR_SPHERE_OBB, "FCL", "sphere-box", depth),
        row<sphere, obb, sphere_from_box>(HP_PAIR_SPHERE_OBB, "FCL", "sphere-box distance", distance),
        row<obb, thin_plane, box_with_plane>(HP_PAIR_OBB_PLANE, "FCL", "box-plane", depth),
        row<obb, half_space, box_with_half_space>(HP_PAIR_OBB_PLANE, "FCL", "box-half-space", depth, "a half-space"),
        row<obb, half_space, box_touches_half_space>(HP_PAIR_OBB_PLANE, "FCL", "box-half-space, F only", F_only,
                                                     "a half-space"),
    };
    solver_rows<by_ccd>(rows, true);
    solver_rows<by_itself>(rows, false);
    return rows;
}

} // namespace

peer_list peers_fcl(void) {
    static const std::vector<peer> rows = make_rows();
    return {rows.data(), rows.size()};
}
