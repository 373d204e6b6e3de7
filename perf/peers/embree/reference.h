// The f64 reference for hits on which octray and Embree disagree: the ray against every triangle, without
// code of either program.
//
// Both work in f32: a ray closer to an edge than their rounding may pass on either side of it. The bound is
// ε = 2⁻²¹·max|v − o|: subtraction and shear of a vertex round by a few 2⁻²⁴ of its distance from the ray's
// origin. A hit whose ray passes more than ε inside every edge is sure; one that passes more than ε outside an
// edge is impossible; between them both results are valid. At a plane met at the angle θ, t moves by ε/|cos θ|,
// so that t may differ by ε·(1 + 1/|cos θ|).
#pragma once

#include "dump.h"

#include <algorithm>
#include <cstdio>

struct Agreement {
    size_t lost_by_octray = 0, lost_by_embree = 0; // hits that only the other has
    size_t other_t = 0;                            // both hit, t differs beyond the bound
    size_t other_primitive = 0;                    // both hit at the same t, but the ray misses one of the triangles
    size_t ties = 0;                               // no disagreement: two triangles at a shared edge, or coincident
    bool is_judged = false;                        // whether disagreements were held against the reference
    size_t judged = 0, octray_right = 0, embree_right = 0, within_bound = 0, both_wrong = 0;
    size_t exact_octray = 0, exact_embree = 0; // of those within the bound: which agree with exact f64
    std::vector<std::string> examples;         // where octray is not simply right, the first few

    size_t disagreements() const { return lost_by_octray + lost_by_embree + other_t + other_primitive; }
};

namespace reference {

using Vector = std::array<double, 3>;

inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }

struct Ray {
    Vector origin, direction; // unit length
    double speed;             // length of the given direction: the unit of t
    double t_max;

    Ray(const Rays& rays, size_t i) : t_max(rays.t_max[i]) {
        for (int axis = 0; axis < 3; axis++) {
            origin[axis] = rays.origin[axis][i];
            direction[axis] = rays.direction[axis][i];
        }
        speed = length(direction);
        for (double& d : direction) d /= speed;
    }
};

// The ray against one triangle.
struct Intersection {
    double inside; // distance by which the ray passes inside the nearest edge, seen along the ray; negative: outside
    double t;
    double bound, t_bound; // rounding error of `inside` and of `t`

    Intersection(const Ray& ray, const Triangle& triangle) {
        Vector v[3];
        double farthest = 0;
        for (int i = 0; i < 3; i++) {
            v[i] = minus({triangle[i][0], triangle[i][1], triangle[i][2]}, ray.origin);
            farthest = std::max(farthest, dot(v[i], v[i]));
        }
        bound = std::sqrt(farthest) * 0x1p-21;
        Vector normal = cross(minus(v[1], v[0]), minus(v[2], v[0]));
        double facing = dot(normal, ray.direction);
        inside = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; i++) {
            const Vector &a = v[i], &b = v[(i + 1) % 3];
            // Twice the area between the ray and the edge over the length of the edge, both projected along
            // the ray.
            double area = dot(ray.direction, cross(a, b)) * (facing < 0 ? -1 : 1);
            double edge = length(cross(minus(b, a), ray.direction));
            inside = std::min(inside, edge > 0 ? area / edge : 0);
        }
        t = dot(normal, v[0]) / facing / ray.speed;
        double cosine = std::abs(facing) / length(normal);
        t_bound = bound * (1 + 1 / cosine) / ray.speed;
        // Edge-on, or without area: any t along it is valid, and so is a miss.
        if (!(cosine > 0)) {
            inside = std::min(inside, 0.0);
            t_bound = std::numeric_limits<double>::infinity();
            t = 0;
        }
    }
    bool possible(const Ray& ray) const { return inside >= -bound && t > -t_bound && t < ray.t_max + t_bound; }
    bool sure(const Ray& ray) const { return inside > bound && t > t_bound && t < ray.t_max - t_bound; }
    bool exact(const Ray& ray) const { return inside >= 0 && t > 0 && t < ray.t_max; }
};

struct GroundTruth {
    bool possible = false;                                  // some triangle may be hit
    double sure = std::numeric_limits<double>::infinity();  // no closest hit lies beyond this
    double exact = std::numeric_limits<double>::infinity(); // closest hit in f64

    GroundTruth(const Ray& ray, const std::vector<Triangle>& triangles) {
        for (const Triangle& triangle : triangles) {
            Intersection m(ray, triangle);
            if (!m.possible(ray)) continue;
            possible = true;
            if (m.sure(ray)) sure = std::min(sure, m.t + m.t_bound);
            if (m.exact(ray)) exact = std::min(exact, m.t);
        }
    }
};

enum class Verdict { wrong, valid, exact };

inline Verdict verdict(const GroundTruth& truth, const Ray& ray, const std::vector<Triangle>& triangles, bool any_hit, uint32_t primitive,
                       double t) {
    bool hits = !std::isinf(truth.exact);
    if (primitive == MISS) return !std::isinf(truth.sure) ? Verdict::wrong : hits ? Verdict::valid : Verdict::exact;
    if (any_hit) return !truth.possible ? Verdict::wrong : hits ? Verdict::exact : Verdict::valid;
    if (primitive >= triangles.size()) return Verdict::wrong;
    Intersection m(ray, triangles[primitive]);
    if (!m.possible(ray) || std::abs(t - m.t) > m.t_bound || m.t - m.t_bound > truth.sure) return Verdict::wrong;
    return m.exact(ray) && m.t - m.t_bound <= truth.exact ? Verdict::exact : Verdict::valid;
}

} // namespace reference

inline Agreement compare(const Rays& rays, const Answers& embree, const std::vector<Triangle>& triangles, bool judge) {
    const Answers& octray = rays.octray;
    Agreement result;
    std::vector<size_t> disputed;
    for (size_t i = 0; i < rays.count; i++) {
        if (octray.hit(i) != embree.hit(i)) {
            (octray.hit(i) ? result.lost_by_embree : result.lost_by_octray)++;
            disputed.push_back(i);
        } else if (octray.hit(i) && !rays.any_hit) {
            uint32_t ours = octray.primitive[i], theirs = embree.primitive[i];
            if (ours == theirs && octray.t[i] == embree.t[i]) continue;
            if (ours >= triangles.size())
                throw std::runtime_error(rays.kind + ".rays: names a triangle that is not dumped; dumps cannot hold spheres");
            reference::Ray ray(rays, i);
            reference::Intersection mine(ray, triangles[ours]), other(ray, triangles[theirs]);
            double apart = std::abs(static_cast<double>(octray.t[i]) - embree.t[i]);
            if (apart > std::max(mine.t_bound, other.t_bound)) {
                result.other_t++;
                disputed.push_back(i);
            } else if (ours != theirs && !(mine.possible(ray) && other.possible(ray))) {
                result.other_primitive++;
                disputed.push_back(i);
            } else if (ours != theirs) {
                result.ties++;
            }
        }
    }
    result.is_judged = judge;
    if (!judge) return result;

    // Every triangle is tested: with a large mesh and many disputes, which are not expected, only a part is
    // checked, and the report says so.
    size_t budget = std::max<size_t>(16, (size_t(1) << 30) / triangles.size());
    for (size_t i : disputed) {
        if (result.judged == budget) break;
        result.judged++;
        using reference::Verdict;
        reference::Ray ray(rays, i);
        reference::GroundTruth truth(ray, triangles);
        Verdict ours = reference::verdict(truth, ray, triangles, rays.any_hit, octray.primitive[i], octray.t[i]);
        Verdict theirs = reference::verdict(truth, ray, triangles, rays.any_hit, embree.primitive[i], embree.t[i]);
        const char* word;
        if (ours != Verdict::wrong && theirs != Verdict::wrong) {
            word = "within bound";
            result.within_bound++;
            result.exact_octray += ours == Verdict::exact;
            result.exact_embree += theirs == Verdict::exact;
        } else if (ours != Verdict::wrong) word = "octray right", result.octray_right++;
        else if (theirs != Verdict::wrong) word = "Embree right", result.embree_right++;
        else word = "both wrong", result.both_wrong++;
        if (ours != Verdict::exact && result.examples.size() < 5) {
            char line[256];
            std::snprintf(line, sizeof line, "ray %zu: octray %d at %.9g, Embree %d at %.9g, f64 %.9g: %s", i,
                          static_cast<int>(octray.primitive[i]), octray.t[i], static_cast<int>(embree.primitive[i]), embree.t[i],
                          truth.exact, word);
            result.examples.push_back(line);
        }
    }
    return result;
}
