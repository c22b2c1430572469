// tinybvh (github.com/jbikker/tinybvh) behind functions that firsthit-bench opens: one mesh, its BVH8_CPU, rays one by one.
// Compiled by `make bench TINYBVH=PATH/tiny_bvh.h`; the header is not part of this repository.
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

using Tree = tinybvh::BVH8_CPU;

struct Line {
    float origin[3], direction[3], t_max;
};

// Tinybvh's own constructor would change the direction's length, and so the unit of t.
static tinybvh::Ray ray_of(const Line &line) {
    tinybvh::Ray ray;
    ray.O = tinybvh::bvhvec3(line.origin[0], line.origin[1], line.origin[2]);
    ray.D = tinybvh::bvhvec3(line.direction[0], line.direction[1], line.direction[2]);
    ray.rD = tinybvh::tinybvh_rcp(ray.D);
    ray.hit.t = line.t_max;
    return ray;
}

extern "C" {

// Four float32 for each corner, three corners for each triangle; they must outlive the tree.
void *tinybvh_build(const float *corners, uint32_t triangles) {
    Tree *tree = new Tree();
    tree->Build(reinterpret_cast<const tinybvh::bvhvec4 *>(corners), triangles);
    return tree;
}

void tinybvh_free(void *tree) { delete static_cast<Tree *>(tree); }

// For each ray t, which is that of its end without a hit, and the triangle.
void tinybvh_first_hits(const void *tree, const Line *lines, size_t count, float *t, uint32_t *triangles) {
    for (size_t k = 0; k < count; k++) {
        tinybvh::Ray ray = ray_of(lines[k]);
        static_cast<const Tree *>(tree)->Intersect(ray);
        t[k] = ray.hit.t;
        triangles[k] = ray.hit.prim;
    }
}

// For each ray one if it meets anything, else zero.
void tinybvh_any_hits(const void *tree, const Line *lines, size_t count, uint32_t *is_met) {
    for (size_t k = 0; k < count; k++) is_met[k] = static_cast<const Tree *>(tree)->IsOccluded(ray_of(lines[k]));
}
}
