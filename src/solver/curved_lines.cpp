#include "solver/curved_lines.h"

#include "laws/contact_curve.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::LARGEST_BEND;
using deformable::LARGEST_SINE;
using deformable::UNKNOWN_FORCE;

void CurvedLines::arrange(ContactBatches &b, NearPairs &p, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
  if (films) films->arrange(b, p, r);
}

// A pair without a past has no tilt either.
void CurvedLines::predict(double slope)
{
  NearPairs &p = *pairs;
  for (LargeVector<double> *const past : {p.past_tilt, p.past_bend}) {
    const double *const last = past[0].data();
    double *const next = past[1].data();
    for (int k = 0; k < p.size; ++k) {
      const bool is_known = p.past_tilt[0][k] != UNKNOWN_FORCE;
      next[k] = is_known ? last[k] + slope * (last[k] - next[k]) : last[k];
    }
    std::swap(past[0], past[1]);
  }
}

void CurvedLines::begin()
{
  const NearPairs &p = *pairs;
  held = false;
  part = 1.0;
  last_imbalance = 0.0;
  for (std::vector<double> *const v : {&next_sine, &next_bend}) v->resize(p.size);
  for (std::vector<double> *const v : {&slope_rate, &per_pressure, &free_radius})
    v->resize(batches->indentation.size());
  if (films) films->begin(outline(), next_bend.data());
  for (int k = 0; k < p.size; ++k) {
    const bool is_known = p.past_tilt[0][k] != UNKNOWN_FORCE;
    const double sine = is_known ? p.past_tilt[0][k] : 0.0,
                 bend = is_known ? p.past_bend[0][k] : 0.0;
    next_sine[k] = std::clamp(sine, -LARGEST_SINE, LARGEST_SINE);
    next_bend[k] = std::clamp(bend, -LARGEST_BEND, LARGEST_BEND);
  }
  take();
}

void CurvedLines::straighten(bool hold)
{
  held = hold;
  for (std::vector<double> *const v : {&next_sine, &next_bend})
    std::fill(v->begin(), v->end(), 0.0);
  part = 1.0;
  last_imbalance = 0.0;
  take();
}

deformable::OutlineArrays CurvedLines::outline()
{
  return {slope_rate.data(), per_pressure.data(), free_radius.data()};
}

deformable::LineArrays CurvedLines::arrays()
{
  NearPairs &p = *pairs;
  deformable::LineArrays a;
  a.per_distance = p.per_distance.data();
  a.force = p.force.data();
  a.first = p.side[0].data();
  a.second = p.side[1].data();
  a.slope = batches->slope.data();
  a.outline = outline();
  a.sine = p.tilt.data();
  a.next_sine = next_sine.data();
  a.bend = p.bend.data();
  a.next_bend = next_bend.data();
  a.overlap = p.overlap.data();
  a.angle = p.angle.data();
  a.nx = p.nx.data();
  a.ny = p.ny.data();
  a.part = part;
  a.adhesion = p.adhesive ? p.adhesion.data() : nullptr;
  return a;
}

double CurvedLines::imbalance()
{
  kernels.slopes(batches->arrays(), pairs->directions(), outline());
  remote->exchange(batches->slope.data(), slope_rate.data());
  remote->exchange(per_pressure.data(), free_radius.data());
  double worst = held ? 0.0 : kernels.find_lines(arrays(), 0, pairs->wall);
  if (films) worst = std::max(worst, films->find(outline(), next_bend.data(), part));
  return remote->largest(worst);
}

// Forces respond to lines, which Newton's method for each line alone does not know. Beyond the model the response may be
// so strong that full steps oscillate.
void CurvedLines::adapt(double imbalance)
{
  constexpr double FALL = 0.1, LEAST = 0.05;    // by this part of the step, at least
  const bool falls = last_imbalance == 0.0 || imbalance < (1.0 - FALL * part) * last_imbalance;
  part = falls ? std::min(1.0, 1.5 * part) : std::max(LEAST, 0.5 * part);
  last_imbalance = imbalance;
}

void CurvedLines::take()
{
  kernels.take_lines(arrays(), 0, pairs->wall);
  if (films) films->take();
}

void CurvedLines::remember()
{
  NearPairs &p = *pairs;
  for (int k = 0; k < p.wall; ++k) {
    const bool is_new = p.past_tilt[0][k] == UNKNOWN_FORCE;
    for (int n = PastForces::LINES - 1; n >= 0; --n) {
      if (n > 0 && !is_new && p.past_tilt[n][k] != UNKNOWN_FORCE) continue;
      p.past_tilt[n][k] = next_sine[k];
      p.past_bend[n][k] = next_bend[k];
    }
  }
  limited = p.sum([&](int begin, int end) {
    int found = 0;
    for (int k = begin; k < end; ++k) {
      const bool sticks = p.adhesive && p.attached[k];
      const bool at_limit =
          held || std::fabs(p.tilt[k]) >= LARGEST_SINE || std::fabs(p.bend[k]) >= LARGEST_BEND;
      found += (k < p.wall && at_limit && (p.force[k] > 0.0 || sticks)) || (sticks && is_held(k));
    }
    return found;
  });
}

// Whether the tensions leave no triangle, so that the angle of the film is held.
bool CurvedLines::is_held(int k) const
{
  const NearPairs &p = *pairs;
  const auto tension = [this](int c) { return free_radius[c] / per_pressure[c]; };
  const double first = tension(p.side[0][k]);
  const double weaker = k < p.wall ? std::min(first, tension(p.side[1][k])) : first;
  return p.adhesion[k] > deformable::LARGEST_ADHESION * weaker;
}

// The chords s of both sides are the same where the bend is right, and the energy is stationary with a multiplier m of
// s_i - s_j beside f. From the derivative by the half angle,
//   m = w b/sin b + 8 p cap s - 2 T (b/sin b - cos alpha) - f u,   f (4 cap - u) without a film.
double CurvedLines::energy_left(int k) const
{
  const NearPairs &p = *pairs;
  if (k >= p.wall) return 0.0;
  const int i = p.side[0][k], j = p.side[1][k];
  const double f = p.force[k], u = p.bend[k], sin_b = 2.0 * u / (1.0 + u * u);
  const deformable::ArcTerms<double> arc = deformable::arc_terms(u);
  const double Qi = free_radius[i], Qj = free_radius[j];
  const double Li = f * per_pressure[i], Lj = f * per_pressure[j];
  if (!films || p.adhesion[k] == 0.0)
    return f * (4.0 * arc.cap - u) * (0.5 * (Li - Lj) + (Qi + Qj) * sin_b);
  const double ti = p.film_angle[0][k], tj = p.film_angle[1][k], x = 1.0 + arc.excess;
  const double si = deformable::half_chord(Li, Qi, ti, u);
  const double sj = deformable::half_chord(Lj, Qj, tj, -u);
  const double half = (ti + u) / (1.0 - ti * u), cos_a = (1.0 - half * half) / (1.0 + half * half);
  const double press = 1.0 / per_pressure[i], T = Qi * press;
  return (p.adhesion[k] * x + 8.0 * press * arc.cap * si - 2.0 * T * (x - cos_a) - f * u) *
         (si - sj);
}
