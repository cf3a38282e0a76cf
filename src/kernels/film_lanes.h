// Loops over pairs whose films stick (contact_film.h), as those of pair_lanes.h.

#ifndef DEFORMABLE_FILM_LANES_H
#define DEFORMABLE_FILM_LANES_H

#include "kernels/pair_lanes.h"
#include "laws/contact_film.h"

namespace deformable::DEFORMABLE_LEVEL {

// With Tf = T_i + T_j - w:  tan^2(theta_i/2) = w (2 T_j - w)/[(2 T_i - w)(2 Tf + w)],
//   (2 Tf T sin theta)^2 = w (2 T_i - w)(2 T_j - w)(2 Tf + w);  of a wall  w/(2 T - w)  and  w (2 T - w).
// The bend has
//   sin(beta + psi) = f (1/p_j - 1/p_i)/(2 c),   (c cos psi, c sin psi) = (q_i cos theta_i + q_j cos theta_j,
//   q_i sin theta_i - q_j sin theta_j).
// The imbalance: what the changes of angles do to the overlap, over the compliances G(0)/p of both rings.
static double find_films(FilmArrays p, int begin, int end)
{
  constexpr double NOTHING = 1e-280;
  const auto look = [&](auto kind, int k, auto &worst) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{}, stated = load<T>(p.adhesion + k);
    const auto of = [&](const double *x, const int *side) DEFORMABLE_LANE_LAMBDA {
      return gather<T>(x, [&](int lane) DEFORMABLE_LANE_LAMBDA { return side[k + lane]; });
    };
    const T qi = of(p.outline.free_radius, p.first), qj = of(p.outline.free_radius, p.second);
    const T per_pi = of(p.outline.per_pressure, p.first),
            per_pj = of(p.outline.per_pressure, p.second);
    const T Ti = qi / larger(per_pi, zero + NOTHING), Tj = qj / larger(per_pj, zero + NOTHING);
    const T w = smaller(stated, LARGEST_ADHESION * smaller(Ti, Tj));
    const T two_i = 2.0 * Ti - w, two_j = 2.0 * Tj - w, film = Ti + Tj - w, all = 2.0 * film + w;
    const T ti = select(w > 0.0, root(w * two_j / (two_i * all)), zero),
            tj = select(w > 0.0, root(w * two_i / (two_j * all)), zero);
    const T pull2 = w * (two_i * two_j) * all;
    store(p.next_angle[0] + k, ti);
    store(p.next_angle[1] + k, tj);
    store(p.next_pull + k, select(w > 0.0, 0.5 * root(pull2) / film, zero));
    if (!any_true(w > 0.0)) return;    // CurvedLines has the bend

    const T per_i = 1.0 / (1.0 + ti * ti), per_j = 1.0 / (1.0 + tj * tj);
    const T across = 2.0 * (qi * ti * per_i - qj * tj * per_j);
    const T along = qi * (1.0 - ti * ti) * per_i + qj * (1.0 - tj * tj) * per_j;
    const T c = larger(root(across * across + along * along), zero + NOTHING), per_c = 1.0 / c;
    const T sine = within(0.5 * load<T>(p.force + k) * (per_pj - per_pi) * per_c, 1.0);
    const T cosine = root(1.0 - sine * sine);
    const T sin_b = within(per_c * (sine * along - cosine * across), 0.5);
    const T bend = load<T>(p.bend + k), change = sin_b / (1.0 + root(1.0 - sin_b * sin_b)) - bend;
    store(p.next_bend + k, select(w > 0.0, bend + p.part * change, load<T>(p.next_bend + k)));
    const T of_i = magnitude(ti - load<T>(p.angle[0] + k)) * qi * ti * per_i * per_i,
            of_j = magnitude(tj - load<T>(p.angle[1] + k)) * qj * tj * per_j * per_j;
    const T arc = 0.5 * load<T>(p.force + k) * (per_pj - per_pi) + across;
    const T off = select(w > 0.0, 4.0 * (of_i + of_j) + magnitude(change * arc), zero);
    worst = larger(worst, off / (GREEN_AT_ZERO * larger(per_pi + per_pj, zero + NOTHING)));
  };
  const int middle = p.wall < end ? larger(p.wall, begin) : end;
  double worst = largest_of(begin, middle, look);
  for (int k = middle; k < end; ++k) {
    const double per_p = p.outline.per_pressure[p.first[k]];
    const double q = p.outline.free_radius[p.first[k]], tension = q / larger(per_p, NOTHING);
    const double w = smaller(p.adhesion[k], LARGEST_ADHESION * tension);
    const double t = w > 0.0 ? root(w / (2.0 * tension - w)) : 0.0, per = 1.0 / (1.0 + t * t);
    const double change = magnitude(t - p.angle[0][k]);
    p.next_angle[0][k] = t;
    p.next_angle[1][k] = p.next_bend[k] = 0.0;
    p.next_pull[k] = w > 0.0 ? root(w * (2.0 * tension - w)) : 0.0;
    worst =
        larger(worst, 4.0 * change * q * t * per * per / (GREEN_AT_ZERO * larger(per_p, NOTHING)));
  }
  return worst;
}

static void take_films(FilmArrays p, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const auto take = [&](int side, const int *contact, T bend) DEFORMABLE_LANE_LAMBDA {
      const T t = load<T>(p.next_angle[side] + k);
      store(p.angle[side] + k, t);
      const FilmTerms<T> terms = film_terms(t, bend, [](T cosine, T sine) DEFORMABLE_LANE_LAMBDA {
        return angle_of_lanes(cosine, sine);
      });
      const T of[] = {terms.perimeter, terms.linear, terms.square, terms.depth};
      for (int n = 0; n < 4; ++n)
        for (int lane = 0; lane < static_cast<int>(sizeof(T) / sizeof(double)); ++lane) {
          double x[sizeof(T) / sizeof(double)];
          store(x, of[n]);
          p.terms[n][contact[k + lane]] = x[lane];
        }
    };
    const T bend = load<T>(p.bend + k);
    take(0, p.first, bend);
    take(1, p.second, -bend);
  });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
