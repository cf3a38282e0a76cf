// Second derivatives of the energy of a ring by the places, directions and curvatures of its contact lines.

#ifndef DEFORMABLE_CURVED_HESSIAN_H
#define DEFORMABLE_CURVED_HESSIAN_H

#include "laws/contact_curve.h"
#include "response/dual.h"
#include "response/energy_blocks.h"
#include "response/ring_parameters.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// A contact of a ring at rest, as it sees it: its force, direction, and u = tan(b/2).
struct BentContact {
  double force, angle, u;
};

struct CurvedHessian {
  double energy = 0.0;
  std::vector<double> curvature;                                               // of the lines
  std::vector<double> by_indentation, by_angle, by_curvature, by_parameter;    // of U
  std::vector<double>
      block;    // of U by a of the n contacts, then theta, curvature, and parameters if these are variables
};

// Sums over the contacts of a ring, see contact_curve.h: p (a + delta), sum f G' and excess/sin^2 b of each, and the load.
template <class T> struct RingSums {
  std::vector<T> product, turning, sweep;
  CurvedLoad<T> load;
};

template <class T>
RingSums<T> ring_sums(const std::vector<T> &force, const std::vector<T> &angle,
                      const std::vector<T> &u)
{
  using std::cos, std::sin;
  const std::size_t n = force.size();
  RingSums<T> sums = {std::vector<T>(n), std::vector<T>(n), std::vector<T>(n), {}};
  T work{}, total{}, excess{}, cap{};
  for (std::size_t c = 0; c < n; ++c) {
    sums.product[c] = GREEN_AT_ZERO * force[c];
    for (std::size_t d = 0; d < n; ++d) {
      if (d == c) continue;
      const T between = angle[c] - angle[d];
      const double turns = std::round(value_of(between) / (2.0 * PI));
      const double sign = value_of(between) < 2.0 * PI * turns ? -1.0 : 1.0;
      const T t = sign * (between - 2.0 * PI * turns);
      sums.product[c] += green(t, sin(t), cos(t)) * force[d];
      sums.turning[c] += sign * d_green(t, sin(t), cos(t)) * force[d];
    }
    const ArcTerms<T> arc = arc_terms(u[c]);
    work += 0.5 * force[c] * sums.product[c];
    total += force[c];
    excess += force[c] * arc.excess;
    cap += force[c] * force[c] * arc.cap;
    sums.sweep[c] = arc.sweep;
  }
  sums.load = curved_load(work, total, excess, cap);
  for (std::size_t c = 0; c < n; ++c) sums.product[c] += sums.load.shift - 0.5 * u[c] * force[c];
  return sums;
}

// The conjugate W(f, theta, kappa) of U(a, theta, kappa), kappa the curvature of each line, has
//   dW/df = a,   dW/dtheta = f t = -dU/dtheta,   dW/dkappa = -f excess/kappa^2 = -dU/dkappa,
// see ring_forces.h and contact_curve.h. Pressure, expansion and all u solve the equations of those files for given f,
// theta and kappa; sin b = kappa s, with half the chord s = f/2p + q sin b. So numbers with derivatives give those of
// the equations, and then W''. With W_ff = A, W_fy = B, W_yy = C for y = (theta, kappa):
//   U_aa = A^-1,   U_ay = -A^-1 B,   U_yy = B^T A^-1 B - C.
// Where the parameters of ring_parameters.h are variables, they belong to y. A line of the curvature kappa bends less as r
// grows: at the same kappa U_r has the further term sum f excess.
// False: the ring bears nothing, or is not stable.
inline bool curved_hessian(double radius, const Stiffness &k,
                           const std::vector<BentContact> &contacts, bool of_parameters,
                           CurvedHessian &h)
{
  const int n = static_cast<int>(contacts.size()), inner = n + 2, lines = 3 * n;
  const int parameters = of_parameters ? RING_PARAMETERS : 0, outer = lines + parameters;
  const std::size_t all = outer + inner;
  std::vector<double> forces, angles, bends;
  for (const BentContact &c : contacts) {
    forces.push_back(c.force);
    angles.push_back(c.angle);
    bends.push_back(c.u);
  }
  const CurvedLoad<double> load = ring_sums(forces, angles, bends).load;
  LoadedRing ring;
  if (!find_pressure(radius, k, {load.work, load.total}, ring) || !(ring.pressure > 0.0))
    return false;
  h.energy = ring.energy(radius, k, load.work);

  const double T0 = tension(radius, ring, load.total);
  std::vector<Dual> force(n), angle(n), curvature(n), u(n), sine(n);
  h.curvature.resize(n);
  for (int c = 0; c < n; ++c) {
    const double sin_b = 2.0 * contacts[c].u / (1.0 + contacts[c].u * contacts[c].u);
    const double s = (0.5 * contacts[c].force + T0 * sin_b) / ring.pressure;
    force[c] = Dual::variable(contacts[c].force, c, all);
    angle[c] = Dual::variable(contacts[c].angle, n + c, all);
    curvature[c] = Dual::variable(sin_b / s, 2 * n + c, all);
    h.curvature[c] = sin_b / s;
    u[c] = Dual::variable(contacts[c].u, outer + 2 + c, all);
    sine[c] = 2.0 * u[c] / (1.0 + u[c] * u[c]);
  }
  const Dual p = Dual::variable(ring.pressure, outer, all);
  const Dual delta = Dual::variable(ring.expansion, outer + 1, all);

  const auto parameter = [&](double value, int which) {
    return of_parameters && std::isfinite(value) ? Dual::variable(value, lines + which, all)
                                                 : Dual(value);
  };
  const Dual r = parameter(radius, OF_RADIUS), kA = parameter(k.kA, OF_KA),
             kP = parameter(k.kP, OF_KP), gamma = parameter(k.tension, OF_TENSION),
             more_area = parameter(0.0, OF_AREA);

  const RingSums<Dual> sums = ring_sums(force, angle, u);
  const Dual T = p * (r + delta) - sums.load.total * (0.5 / PI);

  std::vector<Dual> zero(inner), value(outer);
  zero[0] = k.conserves_perimeter() ? delta : T - Stiffness::line_tension_of(gamma, kP, delta);
  zero[1] =
      (p - gamma / r) / kA - sums.load.work / (p * p) + PI * delta * (2.0 * r + delta) - more_area;
  for (int c = 0; c < n; ++c) {
    zero[2 + c] = sine[c] * (p - curvature[c] * T) - 0.5 * curvature[c] * force[c];
    const Dual half_chord = (0.5 * force[c] + T * sine[c]) / p;
    value[c] = sums.product[c] / p - delta;
    value[n + c] = force[c] * sums.turning[c] / p;
    value[2 * n + c] = -force[c] * sums.sweep[c] * half_chord * half_chord;
  }
  h.by_parameter.clear();
  if (of_parameters) {
    std::array<Dual, RING_PARAMETERS> by = by_parameters(r, kA, gamma, delta, p);
    by[OF_RADIUS] += 2.0 * PI * sums.load.shift;
    for (int k = 0; k < parameters; ++k) {
      value[lines + k] = -by[k];
      h.by_parameter.push_back(by[k].value);
    }
  }
  const auto derivative = [](const Dual &x, int index) { return x.by.empty() ? 0.0 : x.by[index]; };
  std::vector<double> of_inner(inner * inner), response(inner * outer);
  for (int r = 0; r < inner; ++r) {
    for (int c = 0; c < inner; ++c) of_inner[r * inner + c] = derivative(zero[r], outer + c);
    for (int c = 0; c < outer; ++c) response[r * outer + c] = -derivative(zero[r], c);
  }
  if (!solve_by_elimination(of_inner, response, inner, outer)) return false;
  std::vector<double> W(outer * outer);
  for (int r = 0; r < outer; ++r)
    for (int c = 0; c < outer; ++c) {
      double &entry = W[r * outer + c] = derivative(value[r], c);
      for (int m = 0; m < inner; ++m)
        entry += derivative(value[r], outer + m) * response[m * outer + c];
    }

  const int others = outer - n;
  std::vector<double> A(n * n), inverse(n * (n + others), 0.0);    // A^-1 and A^-1 B
  for (int r = 0; r < n; ++r) {
    inverse[r * (n + others) + r] = 1.0;
    for (int c = 0; c < n; ++c) A[r * n + c] = W[r * outer + c];
    for (int c = 0; c < others; ++c) inverse[r * (n + others) + n + c] = W[r * outer + n + c];
  }
  if (!solve_by_elimination(A, inverse, n, n + others)) return false;
  h.block.assign(outer * outer, 0.0);
  for (int r = 0; r < outer; ++r)
    for (int c = 0; c < outer; ++c) {
      double entry = 0.0;
      if (r < n)
        entry = (c < n ? 1.0 : -1.0) * inverse[r * (n + others) + c];
      else if (c < n)
        entry = -inverse[c * (n + others) + r];
      else {
        entry = -W[r * outer + c];
        for (int m = 0; m < n; ++m) entry += W[m * outer + r] * inverse[m * (n + others) + c];
      }
      h.block[r * outer + c] += 0.5 * entry;
      h.block[c * outer + r] += 0.5 * entry;
    }
  for (auto *v : {&h.by_indentation, &h.by_angle, &h.by_curvature}) v->resize(n);
  for (int c = 0; c < n; ++c) {
    h.by_indentation[c] = contacts[c].force;
    h.by_angle[c] = -value[n + c].value;
    h.by_curvature[c] = -value[2 * n + c].value;
  }
  return true;
}

}    // namespace deformable

#endif
