// Who is right where octray and Embree disagree: the ray against every triangle in f64, which imports nothing of either.
//
// Both work in f32: a ray closer to an edge than their rounding may pass on either side of it. The bound is ε = 2⁻²¹·max|v − o|:
// subtraction and shear of a vertex round by a few 2⁻²⁴ of its distance from the ray's origin. A hit whose ray passes more than
// ε inside every edge is sure; one that passes more than ε outside of an edge is impossible; between them both answers stand.
// A plane met at the angle θ moves t by ε/|cos θ|, so that t may differ by ε·(1 + 1/|cos θ|).
#pragma once

#include "dump.h"

#include <algorithm>
#include <cstdio>

struct Agreement {
    size_t lost_by_octray = 0, lost_by_embree = 0; // hits of the other alone
    size_t other_t = 0;                            // both hit, t differs beyond the bound
    size_t other_primitive = 0;                    // both hit at the same t, but one of the triangles is not there
    size_t ties = 0;                               // no disagreement: two triangles at a shared edge, or coincident
    bool asked = false;                            // whether the disagreements below were judged
    size_t judged = 0, octray_right = 0, embree_right = 0, within_bound = 0, both_wrong = 0;
    size_t exact_octray = 0, exact_embree = 0; // of those within the bound: who says what f64 says
    std::vector<std::string> examples;         // where octray is not simply right, the first few

    size_t disagreements() const { return lost_by_octray + lost_by_embree + other_t + other_primitive; }
};

namespace judge {

using Vector = std::array<double, 3>;

inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }

struct Ray {
    Vector origin, direction; // of length one
    double speed;             // the given direction's length: t counts in it
    double reach;

    Ray(const Rays& rays, size_t i) : reach(rays.reach[i]) {
        for (int axis = 0; axis < 3; axis++) {
            origin[axis] = rays.origin[axis][i];
            direction[axis] = rays.direction[axis][i];
        }
        speed = length(direction);
        for (double& d : direction) d /= speed;
    }
};

// The ray's meeting with one triangle.
struct Meeting {
    double inside; // distance by which the ray passes inside the nearest edge, seen along the ray; negative: outside
    double t;
    double bound, t_bound; // what rounding may do to `inside` and to `t`

    Meeting(const Ray& ray, const Triangle& triangle) {
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
            // Twice the area between the ray and the edge, both seen along the ray, over the edge's seen length.
            double area = dot(ray.direction, cross(a, b)) * (facing < 0 ? -1 : 1);
            double edge = length(cross(minus(b, a), ray.direction));
            inside = std::min(inside, edge > 0 ? area / edge : 0);
        }
        t = dot(normal, v[0]) / facing / ray.speed;
        double cosine = std::abs(facing) / length(normal);
        t_bound = bound * (1 + 1 / cosine) / ray.speed;
        // Seen edge-on, or without area: any t along it may be meant, and a miss as well.
        if (!(cosine > 0)) {
            inside = std::min(inside, 0.0);
            t_bound = std::numeric_limits<double>::infinity();
            t = 0;
        }
    }
    bool possible(const Ray& ray) const { return inside >= -bound && t > -t_bound && t < ray.reach + t_bound; }
    bool sure(const Ray& ray) const { return inside > bound && t > t_bound && t < ray.reach - t_bound; }
    bool exact(const Ray& ray) const { return inside >= 0 && t > 0 && t < ray.reach; }
};

struct Truth {
    bool possible = false;                                  // some triangle may be hit
    double sure = std::numeric_limits<double>::infinity();  // no closest hit lies beyond this
    double exact = std::numeric_limits<double>::infinity(); // the closest hit f64 finds

    Truth(const Ray& ray, const std::vector<Triangle>& triangles) {
        for (const Triangle& triangle : triangles) {
            Meeting m(ray, triangle);
            if (!m.possible(ray)) continue;
            possible = true;
            if (m.sure(ray)) sure = std::min(sure, m.t + m.t_bound);
            if (m.exact(ray)) exact = std::min(exact, m.t);
        }
    }
};

enum class Verdict { wrong, stands, exact };

inline Verdict verdict(const Truth& truth, const Ray& ray, const std::vector<Triangle>& triangles, bool any_hit, uint32_t primitive,
                       double t) {
    bool hits = !std::isinf(truth.exact);
    if (primitive == MISS) return !std::isinf(truth.sure) ? Verdict::wrong : hits ? Verdict::stands : Verdict::exact;
    if (any_hit) return !truth.possible ? Verdict::wrong : hits ? Verdict::exact : Verdict::stands;
    if (primitive >= triangles.size()) return Verdict::wrong;
    Meeting m(ray, triangles[primitive]);
    if (!m.possible(ray) || std::abs(t - m.t) > m.t_bound || m.t - m.t_bound > truth.sure) return Verdict::wrong;
    return m.exact(ray) && m.t - m.t_bound <= truth.exact ? Verdict::exact : Verdict::stands;
}

} // namespace judge

inline Agreement compare(const Rays& rays, const Answers& embree, const std::vector<Triangle>& triangles, bool judged) {
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
            judge::Ray ray(rays, i);
            judge::Meeting mine(ray, triangles[ours]), other(ray, triangles[theirs]);
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
    result.asked = judged;
    if (!judged) return result;

    // Every triangle is asked; a great mesh with many disputes (there is no reason for one) is judged in part, and says so.
    size_t budget = std::max<size_t>(16, (size_t(1) << 30) / triangles.size());
    for (size_t i : disputed) {
        if (result.judged == budget) break;
        result.judged++;
        using judge::Verdict;
        judge::Ray ray(rays, i);
        judge::Truth truth(ray, triangles);
        Verdict ours = judge::verdict(truth, ray, triangles, rays.any_hit, octray.primitive[i], octray.t[i]);
        Verdict theirs = judge::verdict(truth, ray, triangles, rays.any_hit, embree.primitive[i], embree.t[i]);
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
