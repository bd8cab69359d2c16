/* Bullet 3.24, in float as Debian builds it: GJK with EPA and its portal refinement for every pair of convex shapes,
 * the detectors it has for some pairs, casts for rays. Collision margins are set to 0, so that shapes have hitpipe's
 * size. */
#include "testbench/peers/row.hh"

#include <BulletCollision/CollisionDispatch/SphereTriangleDetector.h>
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexPlaneCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionDispatch/btSphereBoxCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btSphereSphereCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <memory>

using namespace peers;

namespace {

btVector3 vector_of(point a) {
    return btVector3(btScalar(a.x), btScalar(a.y), btScalar(a.z));
}

btTransform placed(point centre, const point f[3]) {
    btMatrix3x3 frame(btScalar(f[0].x), btScalar(f[1].x), btScalar(f[2].x), btScalar(f[0].y), btScalar(f[1].y),
                      btScalar(f[2].y), btScalar(f[0].z), btScalar(f[1].z), btScalar(f[2].z));
    return btTransform(frame, vector_of(centre));
}

btTransform moved(point centre) {
    return btTransform(btMatrix3x3::getIdentity(), vector_of(centre));
}

/* ---- objects: a shape, its place, and the collision object in which Bullet's algorithms look for both ---- */

template <class Shape> struct body {
    std::unique_ptr<Shape> shape;
    btTransform at;
    std::unique_ptr<btCollisionObject> object;
    body(Shape *made, const btTransform &place) : shape(made), at(place), object(new btCollisionObject) {
        object->setCollisionShape(shape.get());
        object->setWorldTransform(at);
    }
    btCollisionObjectWrapper wrapper() const {
        return btCollisionObjectWrapper(nullptr, shape.get(), object.get(), at, -1, -1);
    }
};

struct sphere : body<btSphereShape> {
    static constexpr size_t words = HP_SPHERE_WORDS;
    sphere(const float *w) : body(new btSphereShape(w[3]), moved(point_of(w))) {}
};

template <class Shape> Shape *without_margin(Shape *shape) {
    shape->setMargin(0);
    return shape;
}

struct box : body<btBoxShape> {
    box(const box_words &b) : body(without_margin(new btBoxShape(vector_of(b.half))), placed(b.centre, b.axis)) {}
};

struct obb : box {
    static constexpr size_t words = HP_OBB_WORDS;
    obb(const float *w) : box(box_of_obb(w)) {}
};

struct aabb : box {
    static constexpr size_t words = HP_AABB_WORDS;
    aabb(const float *w) : box(box_of_aabb(w)) {}
};

struct cylinder : body<btCylinderShapeZ> {
    static constexpr size_t words = HP_CYLINDER_WORDS;
    cylinder(const float *w) : cylinder(cylinder_of(w)) {}
    cylinder(const cylinder_words &c)
        : body(without_margin(new btCylinderShapeZ(vector_of({c.radius, c.radius, c.length / 2}))),
               placed(c.centre, c.frame)) {}
};

struct triangle : body<btTriangleShape> {
    static constexpr size_t words = HP_TRIANGLE_WORDS;
    triangle(const float *w)
        : body(without_margin(new btTriangleShape(vector_of(point_of(w)), vector_of(point_of(w + 3)),
                                                  vector_of(point_of(w + 6)))),
               btTransform::getIdentity()) {}
};

struct half_space : body<btStaticPlaneShape> {
    static constexpr size_t words = HP_PLANE_WORDS;
    half_space(const float *w)
        : body(new btStaticPlaneShape(vector_of(point_of(w)), w[3]), btTransform::getIdentity()) {}
};

struct ray {
    static constexpr size_t words = HP_RAY_WORDS;
    static constexpr double far = 32; /* a cast's fraction is a float, hence no further than the scenes ask for */
    btTransform from, to;
    double scale;
    ray(const float *w) {
        ray_words r = ray_of(w);
        from = moved(r.origin), to = moved(r.origin + far * r.direction), scale = r.scale * far;
    }
};

/* ---- tests ---- */

/* What a detector or an algorithm reports: the deepest of its contacts. Without the manifold in which contacts
 * outlive a step, which hitpipe does not have either. */
struct report : btManifoldResult {
    btScalar least = BT_LARGE_FLOAT;
    report() = default;
    report(const btCollisionObjectWrapper *a, const btCollisionObjectWrapper *b) : btManifoldResult(a, b) {}
    void addContactPoint(const btVector3 &, const btVector3 &, btScalar distance) override {
        least = btMin(least, distance);
    }
    peer_answer answer() const {
        return least < BT_LARGE_FLOAT ? peers::answer(least <= 0, std::fabs(least)) : peers::answer(false);
    }
};

template <class A, class B> peer_answer pair_detector(const A &a, const B &b) {
    static btVoronoiSimplexSolver simplex;
    static btGjkEpaPenetrationDepthSolver epa;
    btGjkPairDetector detector(a.shape.get(), b.shape.get(), &simplex, &epa);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = a.at, input.m_transformB = b.at;
    btPointCollector found;
    detector.getClosestPoints(input, found, nullptr);
    if (!found.m_hasResult) return cannot_tell;
    return answer(found.m_distance <= 0, std::fabs(found.m_distance));
}

template <class A, class B> peer_answer epa2(const A &a, const B &b) {
    btGjkEpaSolver2::sResults results;
    btVector3 guess = b.at.getOrigin() - a.at.getOrigin();
    bool F = btGjkEpaSolver2::Penetration(a.shape.get(), a.at, b.shape.get(), b.at, guess, results, true);
    if (!F && results.status == btGjkEpaSolver2::sResults::EPA_Failed) return cannot_tell;
    return answer(F, F ? -results.distance : unsaid);
}

template <class A, class B> peer_answer gjk2_distance(const A &a, const B &b) {
    btGjkEpaSolver2::sResults results;
    btVector3 guess = b.at.getOrigin() - a.at.getOrigin();
    bool apart = btGjkEpaSolver2::Distance(a.shape.get(), a.at, b.shape.get(), b.at, guess, results);
    if (!apart && results.status == btGjkEpaSolver2::sResults::GJK_Failed) return cannot_tell;
    double T =
        double(results.distance) - a.shape->getMargin() - b.shape->getMargin(); /* a sphere is a point and margin */
    apart = apart && T > 0;
    return answer(!apart, apart ? T : unsaid);
}

peer_answer box_box_detector(const obb &a, const obb &b) {
    btBoxBoxDetector detector(a.shape.get(), b.shape.get());
    btBoxBoxDetector::ClosestPointInput input;
    input.m_transformA = a.at, input.m_transformB = b.at;
    report found;
    detector.getClosestPoints(input, found, nullptr);
    return found.answer();
}

peer_answer sphere_triangle_detector(const triangle &t, const sphere &s) {
    static btVector3 nearest, normal;
    SphereTriangleDetector detector(s.shape.get(), t.shape.get(), 0);
    btScalar distance = 0, time = 1;
    bool F = detector.collide(s.at.getOrigin(), nearest, normal, distance, time, 0);
    return answer(F, F ? -distance : unsaid);
}

/* Algorithms that Bullet keeps for each pair of bodies near each other: one for all, since it has nothing to
 * remember. */
struct algorithms {
    btPersistentManifold manifold;
    btCollisionAlgorithmConstructionInfo info;
    btDispatcherInfo dispatch;
};

algorithms &kept() {
    static algorithms all;
    return all;
}

template <class Algorithm, class A, class B> peer_answer run(Algorithm &algorithm, const A &a, const B &b) {
    btCollisionObjectWrapper of_a = a.wrapper(), of_b = b.wrapper();
    report found(&of_a, &of_b);
    algorithm.processCollision(&of_a, &of_b, kept().dispatch, &found);
    return found.answer();
}

peer_answer sphere_sphere(const sphere &a, const sphere &b) {
    static btCollisionObjectWrapper of_a = a.wrapper(), of_b = b.wrapper();
    static btSphereSphereCollisionAlgorithm algorithm(&kept().manifold, kept().info, &of_a, &of_b);
    return run(algorithm, a, b);
}

peer_answer box_plane(const obb &b, const half_space &h) {
    static btCollisionObjectWrapper of_b = b.wrapper(), of_h = h.wrapper();
    static btConvexPlaneCollisionAlgorithm algorithm(&kept().manifold, kept().info, &of_b, &of_h, false, 0, 0);
    return run(algorithm, b, h);
}

peer_answer sphere_box(const sphere &s, const obb &b) {
    static btCollisionObjectWrapper of_s = s.wrapper(), of_b = b.wrapper();
    static btSphereBoxCollisionAlgorithm algorithm(&kept().manifold, kept().info, &of_s, &of_b, false);
    btCollisionObjectWrapper box = b.wrapper();
    btVector3 nearest, normal;
    btScalar distance = 0;
    bool F = algorithm.getSphereDistance(&box, nearest, normal, distance, s.at.getOrigin(), s.shape->getRadius(), 0);
    return answer(F, F ? std::fabs(distance) : unsaid);
}

struct first_hit : btTriangleRaycastCallback {
    using btTriangleRaycastCallback::btTriangleRaycastCallback;
    btScalar fraction = 2;
    btScalar reportHit(const btVector3 &, btScalar at, int, int) override { return fraction = at; }
};

peer_answer ray_to_triangle(const ray &r, const triangle &t) {
    first_hit hit(r.from.getOrigin(), r.to.getOrigin());
    hit.processTriangle(t.shape->m_vertices1, 0, 0);
    bool F = hit.fraction <= 1;
    return answer(F, F ? hit.fraction * r.scale : unsaid);
}

template <class B> peer_answer cast(const ray &r, const B &b) {
    static btSphereShape nothing(0);
    static btVoronoiSimplexSolver simplex;
    btSubsimplexConvexCast caster(&nothing, b.shape.get(), &simplex);
    btConvexCast::CastResult result;
    result.m_fraction = 1;
    bool F = caster.calcTimeOfImpact(r.from, r.to, b.at, b.at, result);
    return answer(F, F ? result.m_fraction * r.scale : unsaid);
}

/* ---- rows ---- */

template <class A, class B> void add(std::vector<peer> &rows, hp_pair pair) {
    rows.push_back(row<A, B, epa2<A, B>>(pair, "Bullet", "btGjkEpaSolver2::Penetration", depth));
    rows.push_back(row<A, B, gjk2_distance<A, B>>(pair, "Bullet", "btGjkEpaSolver2::Distance", distance));
    rows.push_back(row<A, B, pair_detector<A, B>>(pair, "Bullet", "btGjkPairDetector", both));
}

std::vector<peer> make_rows() {
    std::vector<peer> rows = {
        row<ray, triangle, ray_to_triangle>(HP_PAIR_RAY_TRIANGLE, "Bullet", "btTriangleRaycastCallback", depth,
                                            "a segment; its edges reach out by a tolerance"),
        row<ray, sphere, cast<sphere>>(HP_PAIR_RAY_SPHERE, "Bullet", "btSubsimplexConvexCast", depth,
                                       "a segment; from inside, a miss"),
        row<ray, cylinder, cast<cylinder>>(HP_PAIR_RAY_CYLINDER, "Bullet", "btSubsimplexConvexCast", depth,
                                           "a segment; from inside, a miss"),
        row<obb, obb, box_box_detector>(HP_PAIR_OBB_OBB, "Bullet", "btBoxBoxDetector", depth,
                                        "prefers faces to edges by 5 %"),
        row<sphere, sphere, sphere_sphere>(HP_PAIR_SPHERE_SPHERE, "Bullet", "btSphereSphereCollisionAlgorithm",
                                           depth),
        row<triangle, sphere, sphere_triangle_detector>(HP_PAIR_TRIANGLE_SPHERE, "Bullet", "SphereTriangleDetector",
                                                        depth),
        row<obb, half_space, box_plane>(HP_PAIR_OBB_PLANE, "Bullet", "btConvexPlaneCollisionAlgorithm", depth,
                                        "a half-space"),
        row<sphere, obb, sphere_box>(HP_PAIR_SPHERE_OBB, "Bullet", "btSphereBoxCollisionAlgorithm", depth),
    };
    add<obb, obb>(rows, HP_PAIR_OBB_OBB);
    add<triangle, aabb>(rows, HP_PAIR_TRIANGLE_AABB);
    add<triangle, obb>(rows, HP_PAIR_TRIANGLE_OBB);
    add<sphere, sphere>(rows, HP_PAIR_SPHERE_SPHERE);
    add<triangle, sphere>(rows, HP_PAIR_TRIANGLE_SPHERE);
    add<triangle, cylinder>(rows, HP_PAIR_TRIANGLE_CYLINDER);
    add<cylinder, cylinder>(rows, HP_PAIR_CYLINDER_CYLINDER);
    add<obb, cylinder>(rows, HP_PAIR_OBB_CYLINDER);
    add<sphere, obb>(rows, HP_PAIR_SPHERE_OBB);
    return rows;
}

} // namespace

peer_list peers_bullet(void) {
    static const std::vector<peer> rows = make_rows();
    return {rows.data(), rows.size()};
}
