#include "solver/curved_lines.h"

#include "laws/contact_curve.h"

#include <algorithm>
#include <cmath>

namespace deformable {

void CurvedLines::arrange(ContactBatches &b, NearPairs &p, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
  const int rings = b.batches * LANES;
  for (int k = 0; k < p.size; ++k) {
    p.ring[0][k] = b.place[p.i[k]];
    p.ring[1][k] = k < p.remote ? b.place[p.second(k)] : k < p.wall ? rings + k - p.remote : 0;
  }
  r.arrange_rings(p.ring[0].data() + p.remote, rings);
  next_sine.assign(p.size, 0.0);
  // one more than pairs: the last one stands for places of contacts that are empty
  answer.assign(p.size + 1, 0.0);
  for (LargeVector<float> *const v :
       {&give, &first_flow, &flow_per_press, &curvature, &feedback, &left})
    v->assign(p.size + 1, 0.0F);
  if (films) films->arrange(b, p, r);
}

// A pair without a past has no tilt either.
void CurvedLines::predict(const Extrapolation &by, int begin, int end)
{
  NearPairs &p = *pairs;
  kernels.extrapolate(p.past[TILT].arrays(), by, nullptr, next_sine.data(), begin, end);
  kernels.extrapolate(p.past[BEND].arrays(), by, nullptr, p.bend.data(), begin, end);
}

void CurvedLines::take_past()
{
  NearPairs &p = *pairs;
  const auto take_last = [&p](int kind, LargeVector<double> &value) {
    const LargeVector<double> &last = p.past[kind].last;
    for (int k = 0; k < p.wall; ++k) value[k] = last[k] == UNKNOWN ? 0.0 : last[k];
  };
  take_last(TILT, next_sine);
  take_last(BEND, p.bend);
}

void CurvedLines::begin()
{
  NearPairs &p = *pairs;
  held = false;
  answers = true;
  part = 1.0;
  last_imbalance = 0.0;
  for (int k = 0; k < p.wall; ++k) {
    next_sine[k] = std::clamp(next_sine[k], -LARGEST_SINE, LARGEST_SINE);
    p.bend[k] = std::clamp(p.bend[k], -LARGEST_BEND, LARGEST_BEND);
  }
  if (films) films->begin();
  turn(0, pairs->size);
}

void CurvedLines::straighten(bool hold)
{
  held = hold;
  std::fill(next_sine.begin(), next_sine.end(), 0.0);
  std::fill(pairs->bend.begin(), pairs->bend.end(), 0.0);
  if (films) films->begin();
  part = 1.0;
  last_imbalance = 0.0;
  turn(0, pairs->size);
}

void CurvedLines::let_go()
{
  held = false;
  answers = false;
  part = 0.2;
  last_imbalance = 0.0;
}

// Lines of walls stay, their films do not.
void CurvedLines::turn(int begin, int end)
{
  kernels.turn_lines(arrays(), begin, std::min(end, pairs->wall));
  if (films) films->take(begin, end);
}

double CurvedLines::find(const PairArrays &loop, int begin, int end)
{
  double worst = held ? 0.0 : kernels.find_lines(loop, arrays(), begin, end);
  if (films) worst = std::max(worst, films->find(begin, end));
  return worst;
}

void CurvedLines::find_answers(const PairArrays &loop, int begin, int end)
{
  kernels.answer(loop, arrays(), begin, std::min(end, pairs->wall));
}

void CurvedLines::settle(const PairArrays &loop, int begin, int end)
{
  kernels.settle(loop, arrays(), begin, std::min(end, pairs->wall));
  turn(begin, end);
}

LineArrays CurvedLines::arrays()
{
  NearPairs &p = *pairs;
  LineArrays a;
  a.per_distance = p.per_distance.data();
  for (int side = 0; side < 2; ++side) a.ring[side] = p.ring[side].data();
  a.slope = batches->slope.data();
  a.pressure = batches->pressure.data();
  a.outline = batches->arrays().outline;
  a.sine = p.tilt.data();
  a.next_sine = next_sine.data();
  a.bend = p.bend.data();
  a.overlap = p.overlap.data();
  a.angle = p.angle.data();
  a.nx = p.nx.data();
  a.ny = p.ny.data();
  a.give = give.data();
  a.answer = answer.data();
  a.first_flow = first_flow.data();
  a.flow_per_press = flow_per_press.data();
  a.curvature = curvature.data();
  a.feedback = feedback.data();
  a.left = left.data();
  a.part = part;
  a.wall = p.wall;
  for (int side = 0; side < 2; ++side)
    a.film_angle[side] = p.adhesive ? p.film_angle[side].data() : nullptr;
  return a;
}

void CurvedLines::exchange_outlines()
{
  ContactBatches &b = *batches;
  remote->exchange(b.slope.data(), b.rate_of_slope.data());
  remote->exchange_rings(b.pressure.data(), b.free_radius_of.data(), b.bulk_and_swell.data());
}

void CurvedLines::exchange_answers()
{
  ContactBatches &b = *batches;
  remote->exchange(b.across.data());
  remote->exchange_rings(b.change.data());
}

void CurvedLines::forget_answers()
{
  std::fill(batches->across.begin(), batches->across.end(), 0.0F);
  std::fill(batches->change.begin(), batches->change.end(), 0.0);
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

void CurvedLines::remember()
{
  NearPairs &p = *pairs;
  kernels.remember_values(p.past[TILT].arrays(), next_sine.data(), 0, p.wall);
  kernels.remember_values(p.past[BEND].arrays(), p.bend.data(), 0, p.wall);
}

void CurvedLines::count_limited()
{
  const NearPairs &p = *pairs;
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
  const auto tension = [this](int ring) {
    return batches->free_radius_of[ring] * batches->pressure[ring];
  };
  const double first = tension(p.ring[0][k]);
  const double weaker = k < p.wall ? std::min(first, tension(p.ring[1][k])) : first;
  return p.adhesion[k] > LARGEST_ADHESION * weaker;
}

// The chords s of both sides are the same where the bend is right, and the energy is stationary with a multiplier m of
// s_i - s_j beside f. From the derivative by the half angle,
//   m = w b/sin b + 8 p cap s - 2 T (b/sin b - cos alpha) - f u,   f (4 cap - u) without a film.
double CurvedLines::energy_left(int k) const
{
  const NearPairs &p = *pairs;
  if (k >= p.wall || (p.force[k] == 0.0 && !films)) return 0.0;
  const int i = p.ring[0][k], j = p.ring[1][k];
  const double f = p.force[k], u = p.bend[k], sin_b = 2.0 * u / (1.0 + u * u);
  const ArcTerms<double> arc = arc_terms(u);
  const double Qi = batches->free_radius_of[i], Qj = batches->free_radius_of[j];
  const double press = batches->pressure[i], Li = f / press, Lj = f / batches->pressure[j];
  if (!films || p.adhesion[k] == 0.0)
    return f * (4.0 * arc.cap - u) * (0.5 * (Li - Lj) + (Qi + Qj) * sin_b);
  const double ti = p.film_angle[0][k], tj = p.film_angle[1][k], x = 1.0 + arc.excess;
  const double si = half_chord(Li, Qi, ti, u);
  const double sj = half_chord(Lj, Qj, tj, -u);
  const double half = (ti + u) / (1.0 - ti * u), cos_a = (1.0 - half * half) / (1.0 + half * half);
  const double T = Qi * press;
  return (p.adhesion[k] * x + 8.0 * press * arc.cap * si - 2.0 * T * (x - cos_a) - f * u) *
         (si - sj);
}

}    // namespace deformable
