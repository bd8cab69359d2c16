/* ODE 0.16, in double: dCollide over its geoms, and dBoxBox without them. A triangle is a mesh of one triangle, a ray
 * a segment, a plane a half-space. */
#include "testbench/peers/row.hh"

#include <memory>
#include <ode/ode.h>

using namespace peers;

namespace {

/* Colliders, and the caches of meshes of this thread. */
struct library {
    library() { dInitODE2(0), dAllocateODEDataForThread(dAllocateMaskAll); }
    ~library() { dCloseODE(); }
};

void begin() {
    static const library once;
}

void put_frame(const point axis[3], dMatrix3 frame) {
    for (int i = 0; i < 3; i++) frame[i] = axis[i].x, frame[4 + i] = axis[i].y, frame[8 + i] = axis[i].z;
    for (int row = 0; row < 3; row++) frame[4 * row + 3] = 0;
}

void place(dGeomID geom, point centre, const point frame[3]) {
    dMatrix3 r;
    put_frame(frame, r);
    dGeomSetPosition(geom, centre.x, centre.y, centre.z);
    dGeomSetRotation(geom, r);
}

/* ---- objects ---- */

struct geom_end {
    void operator()(dxGeom *geom) const { dGeomDestroy(geom); }
};

/* ODE finds the place and bounding box of a geom when first asked; asking here keeps that out of what is timed. */
struct geom {
    std::unique_ptr<dxGeom, geom_end> id;
    geom(dGeomID made) : id(made) {}
    void settle() {
        dReal bounds[6];
        dGeomGetAABB(id.get(), bounds);
    }
};

struct sphere : geom {
    static constexpr size_t words = HP_SPHERE_WORDS;
    sphere(const float *w) : geom(dCreateSphere(nullptr, w[3])) {
        dGeomSetPosition(id.get(), w[0], w[1], w[2]);
        settle();
    }
};

struct box : geom {
    box(const box_words &b) : geom(dCreateBox(nullptr, 2 * b.half.x, 2 * b.half.y, 2 * b.half.z)) {
        place(id.get(), b.centre, b.axis);
        settle();
    }
};

struct obb : box {
    static constexpr size_t words = HP_OBB_WORDS;
    obb(const float *w) : box(box_of_obb(w)) {}
};

struct aabb : box {
    static constexpr size_t words = HP_AABB_WORDS;
    aabb(const float *w) : box(box_of_aabb(w)) {}
};

struct bare_box {
    static constexpr size_t words = HP_OBB_WORDS;
    dVector3 centre, sides;
    dMatrix3 frame;
    bare_box(const float *w) : bare_box(box_of_obb(w)) {}
    bare_box(const box_words &b)
        : centre{b.centre.x, b.centre.y, b.centre.z, 0}, sides{2 * b.half.x, 2 * b.half.y, 2 * b.half.z, 0} {
        put_frame(b.axis, frame);
    }
};

struct cylinder : geom {
    static constexpr size_t words = HP_CYLINDER_WORDS;
    cylinder(const float *w) : cylinder(cylinder_of(w)) {}
    cylinder(const cylinder_words &c) : geom(dCreateCylinder(nullptr, c.radius, c.length)) {
        place(id.get(), c.centre, c.frame);
        settle();
    }
};

struct half_space : geom {
    static constexpr size_t words = HP_PLANE_WORDS;
    half_space(const float *w) : geom(dCreatePlane(nullptr, w[0], w[1], w[2], w[3])) { settle(); }
};

struct ray : geom {
    static constexpr size_t words = HP_RAY_WORDS;
    double scale;
    ray(const float *w) : geom(dCreateRay(nullptr, reach)) {
        ray_words r = ray_of(w);
        dGeomRaySet(id.get(), r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z);
        scale = r.scale;
        settle();
    }
};

struct mesh_data {
    dReal corner[3][4];
    dTriIndex index[3] = {0, 1, 2};
    dTriMeshDataID id;
    mesh_data(const float *w) : id(dGeomTriMeshDataCreate()) {
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) corner[v][axis] = w[3 * v + axis];
        dGeomTriMeshDataBuildDouble(id, corner, sizeof corner[0], 3, index, 3, sizeof index);
    }
    mesh_data(const mesh_data &) = delete;
    ~mesh_data() { dGeomTriMeshDataDestroy(id); }
};

struct triangle {
    static constexpr size_t words = HP_TRIANGLE_WORDS;
    std::unique_ptr<mesh_data> data;
    geom mesh;
    triangle(const float *w)
        : data((begin(), new mesh_data(w))), mesh(dCreateTriMesh(nullptr, data->id, nullptr, nullptr, nullptr)) {
        mesh.settle();
    }
};

dGeomID id_of(const geom &g) {
    return g.id.get();
}

dGeomID id_of(const triangle &t) {
    return t.mesh.id.get();
}

/* ---- tests ---- */

constexpr int contacts_max = 16;

/* The depth of the deepest of at most `flags` contacts. */
template <class A, class B, int flags> peer_answer depth_of(const A &a, const B &b) {
    dContactGeom contact[contacts_max];
    int n = dCollide(id_of(a), id_of(b), flags, contact, sizeof *contact);
    double T = unsaid;
    for (int i = 0; i < n; i++) T = std::fmax(T, contact[i].depth);
    return answer(n > 0, T);
}

template <class A, class B> peer_answer touch(const A &a, const B &b) {
    dContactGeom contact;
    return answer(dCollide(id_of(a), id_of(b), 1 | CONTACTS_UNIMPORTANT, &contact, sizeof contact) > 0);
}

/* The depth of a contact of a ray is the way to it. */
template <class B> peer_answer way_to(const ray &r, const B &b) {
    dContactGeom contact;
    bool F = dCollide(id_of(r), id_of(b), 1, &contact, sizeof contact) > 0;
    return answer(F, F ? contact.depth * r.scale : unsaid);
}

peer_answer ray_to_triangle(const ray &r, const triangle &t) {
    dContactGeom contact;
    bool F = dCollide(id_of(t), id_of(r), 1, &contact, sizeof contact) > 0;
    return answer(F, F ? contact.depth * r.scale : unsaid);
}

peer_answer boxes(const bare_box &a, const bare_box &b) {
    dVector3 normal;
    dReal T;
    int code;
    dContactGeom contact;
    bool F = dBoxBox(a.centre, a.frame, a.sides, b.centre, b.frame, b.sides, normal, &T, &code, 1, &contact,
                     sizeof contact) > 0;
    return answer(F, F ? T : unsaid);
}

/* ---- rows ---- */

template <class A, class B> void add(std::vector<peer> &rows, hp_pair pair, const char *note) {
    rows.push_back(row<A, B, depth_of<A, B, 1>>(pair, "ODE", "dCollide", depth, note));
}

template <class B> void add_ray(std::vector<peer> &rows, hp_pair pair) {
    rows.push_back(
        row<ray, B, way_to<B>>(pair, "ODE", "dCollide", depth, "a segment; from inside, T is the way out"));
}

template <class B> void add_mesh(std::vector<peer> &rows, hp_pair pair, const char *note) {
    rows.push_back(row<triangle, B, touch<triangle, B>>(pair, "ODE", "dCollide, any contact", F_only, note));
    rows.push_back(
        row<triangle, B, depth_of<triangle, B, contacts_max>>(pair, "ODE", "dCollide, 16 contacts", depth, note));
}

std::vector<peer> make_rows() {
    begin();
    std::vector<peer> rows = {
        row<ray, triangle, ray_to_triangle>(HP_PAIR_RAY_TRIANGLE, "ODE", "dCollide", depth, "a segment"),
        row<bare_box, bare_box, boxes>(HP_PAIR_OBB_OBB, "ODE", "dBoxBox", depth, "prefers faces to edges by 5 %"),
    };
    add_mesh<aabb>(rows, HP_PAIR_TRIANGLE_AABB, "");
    add_mesh<obb>(rows, HP_PAIR_TRIANGLE_OBB, "");
    add<sphere, sphere>(rows, HP_PAIR_SPHERE_SPHERE, "");
    add_mesh<sphere>(rows, HP_PAIR_TRIANGLE_SPHERE, "one side of the triangle");
    add_ray<cylinder>(rows, HP_PAIR_RAY_CYLINDER);
    add_mesh<cylinder>(rows, HP_PAIR_TRIANGLE_CYLINDER, "one side of the triangle");
    add<cylinder, cylinder>(rows, HP_PAIR_CYLINDER_CYLINDER, "by libccd");
    add<obb, cylinder>(rows, HP_PAIR_OBB_CYLINDER, "");
    add<obb, half_space>(rows, HP_PAIR_OBB_PLANE, "a half-space");
    add_ray<sphere>(rows, HP_PAIR_RAY_SPHERE);
    add<sphere, obb>(rows, HP_PAIR_SPHERE_OBB, "");
    return rows;
}

} // namespace

peer_list peers_ode(void) {
    static const std::vector<peer> rows = make_rows();
    return {rows.data(), rows.size()};
}
