// Contact lines that tilt until the torques of both rings balance, and bend until their pressures do.
//
// The line of a pair at distance d is at rest where d sin(tilt) = t_i + t_j, with the slopes t of both outlines, and where
// its curvature is (p_i - p_j)/(T_i + T_j), with the tensions T of the outlines (contact_curve.h). This is where its energy
// is smallest or, if it bears no force, where the outlines would touch first. The imbalance of a line is a force: the torque on
// it over d, or what its bend at rest would do to forces.
//
// Forces, tilts and bends depend on each other: what lines do undoes up to a third of a correction of forces alone. So lines answer
// while a correction is found (DualSolver, curve_lanes.h), and turn with it. With C at fixed curvature, tilts tau and flows q,
//   C df + N df' + M q = r,   f' = f dtau,   k dtau + O f' = N^T df - g,   q = phi [dp_i - dp_j - curvature (dT_i + dT_j)],
// g the torques, k the stiffness of a line against tilts. A step of Jacobi's method for tilts and flows comes before each of one or
// two solutions with C, and one in the end. Where forces are far from balance, or that leads astray, lines turn after a correction of
// forces alone, and by less where their imbalances do not fall.
//
// No line tilts by more than 0.3 rad, or bends by more than 30 degrees. At the limit the energy is smallest over the lines
// that are allowed, so it has no jump there. Beyond the model the tilts may have several solutions: which one is found then
// depends on the past. Lines of walls stay where they are.

#ifndef DEFORMABLE_CURVED_LINES_H
#define DEFORMABLE_CURVED_LINES_H

#include "solver/contact_batches.h"
#include "solver/near_pairs.h"
#include "solver/remote_sides.h"
#include "solver/ring_films.h"

namespace deformable {

class CurvedLines {
 public:
  explicit CurvedLines(const ForceKernels &kernels) : kernels(kernels) {}

  RingFilms *films = nullptr;    // of adhesive contacts

  // Lines of the last solution that bear a force at a limit. A line that two ranks share counts half on each.
  double limited = 0.0;

  bool held = false;    // all lines stay straight in this solution
  bool answers =
      true;    // lines answer while corrections are found; DualSolver: not after a step that led astray
  double part = 1.0;    // of the step to the next tilts and bends

  void arrange(ContactBatches &, NearPairs &, RemoteSides &);    // contacts are new

  // The first tilts and bends of a call, of some pairs, from those of the last ones; all, of another solution of this call.
  void predict(const Extrapolation &, int begin, int end);
  void take_past();

  // Lines of pairs that are straight yet take them.
  void begin();

  // All lines are straight, and perpendicular to lines of centers; held: they stay so in this solution.
  void straighten(bool held);
  void let_go();    // they may turn from there

  // Stages of a sweep, see DualSolver, of some pairs: the imbalance of their lines, a force; how they answer outlines; and the
  // next tilts, bends and films.
  double find(const PairArrays &, int begin, int end);
  void find_answers(const PairArrays &, int begin, int end);
  void settle(const PairArrays &, int begin, int end);

  // Steps become shorter where imbalances do not fall, and longer again where they do.
  void adapt(double imbalance);

  // After an evaluation, between ranks; and after outlines have followed.
  void exchange_outlines();
  void exchange_answers();
  void forget_answers();

  LineArrays arrays();

  void remember();         // for the next call
  void count_limited();    // see `limited`

  // The energy that pairs add to those of their rings, whose error is then of second order: for what is left of the
  // balance, the bend of a pair makes the chords of both sides differ.
  double energy_left(int k) const;

  double bytes() const
  {
    return bytes_of(next_sine, answer, give, first_flow, flow_per_press, curvature, feedback, left);
  }

 private:
  const ForceKernels &kernels;
  NearPairs *pairs = nullptr;
  ContactBatches *batches = nullptr;
  RemoteSides *remote = nullptr;
  LargeVector<double> next_sine, answer;    // see LineArrays
  LargeVector<float> give, first_flow, flow_per_press, curvature, feedback, left;
  double last_imbalance = 0.0;
  bool is_held(int k) const;
  void turn(int begin, int end);
};

}    // namespace deformable

#endif
