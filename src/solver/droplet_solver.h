// The forces of all pairs of droplets, from positions.
//
// The forces F are the largest value of
//   sum over pairs of F o - sum over droplets of W,   F >= 0
// with W of droplet.h and the overlaps o = R_i + R_j - d; of a wall o = R - h. Its gradient is what is left of an overlap,
//   r = o - a_i - a_j,   0 where F > 0, not positive where F = 0.
//
// Newton's method finds it. A step solves C x = r with the compliances C of all droplets, for the pairs that bear a force, by
// conjugate gradients, which need few iterations: each pair alone has most of its compliance. They are in single precision, and
// so are the changes of indentations by a small step; F and what follows from it are in double precision.
//
// C is that of the forces before the step. Along the step it changes mostly because the indentation that a force makes under
// itself goes like F ln(1/F). Of a pair alone that is known exactly (bent_step), which steps use three times:
//   before: pairs that open, close or change by much of their force do so alone, and the step begins there (switch_pairs). A
//     pair closes where its own force would become negative, and opens with the force that it would have alone.
//   within: when a long step, but no far one, is known to a hundredth, its forces bend to where their own indentation is what C
//     promised. The rest of the step makes up for what other pairs get or lose by that (bend_steps).
//   at the end: the forces that are taken bend, too (force_after).
// A step that is too long is halved (search). Where that does not help either, pairs go by half of their own step (relax).
//
// The imbalance of a pair is the change of its force that would remove r if all others stayed. The solution is found when none
// exceeds the tolerance times the largest force. In motion the forces of the last calls predict the next ones (ForcePredictor),
// and mostly one step is enough.
//
// All ranks do the same steps. Both ranks of a pair have its force and, but for rounding, its overlap. Each has the indentation of
// its own droplet, and that of the other one from the other rank.

#ifndef LMP_DROPLET_SOLVER_H
#define LMP_DROPLET_SOLVER_H

#include "pointers.h"

#include "solver/droplet_list.h"
#include "solver/force_predictor.h"

#include "kernels/droplet_kernels.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {

class DropletSolver : protected Pointers {
 public:
  DropletSolver(class LAMMPS *lmp, const deformable::DropletKernels &kernels, double tolerance,
                int most)
      : Pointers(lmp),
        tolerance(tolerance),
        most_steps(most),
        kernels(kernels)
  {
  }

  const double tolerance;    // of the imbalance over the largest force
  int steps = 0;             // of Newton's method, in the last call
  double imbalance = 0.0;    // over the largest force

  void arrange(const DropletScene &, DropletList &);    // pairs are new
  void set_material(const DropletScene &);

  // Forces continue those of the last calls; or they are those of the last solution.
  void begin_call();
  void take_past();
  // Pairs know their places. May be called again in the same call, with other pairs. Returns whether forces are balanced.
  bool solve();
  // The forces are the past ones of the next call; after it, those of a next call do not continue these.
  void remember();
  void forget() { predictor.forget(); }

  // Of a droplet, by local index.
  double load(int i) const { return of_load[rows[i]]; }
  double facet(int i) const { return of_facet[rows[i]]; }
  double work(int i) const { return of_work[rows[i]]; }
  int contacts_of(int i) const { return contacts[rows[i]]; }
  int place_of_contact(int i, int contact) const { return place_of(rows[i], contact); }
  int seat(int place) const { return seats[place]; }    // 2 x the pair, + 1 for its second droplet
  double indentation(int place) const { return indentations[place]; }
  int place(int k, int side) const { return sides[side][k]; }
  double residual(int k) const { return residuals[k]; }
  // dW/dn of a contact, over R F
  double turn(int place, int axis) const { return turns[axis][place]; }

  double memory_usage() const;

 private:
  const int most_steps;
  const deformable::DropletKernels &kernels;
  ForcePredictor predictor;
  DropletPairs *pairs = nullptr;
  RemoteSides *remote = nullptr;

  int batches = 0, longest = 0;    // contacts of the largest batch
  std::vector<int> rows;           // by local index: batch x LANES + lane; -1 of other styles
  std::vector<int> contacts;       // by row
  int place_of(int row, int contact) const
  {
    using deformable::LANES;
    return (first[row / LANES] + contact) * LANES + row % LANES;
  }
  void sort(const NeighList *);
  LargeVector<int> first;
  LargeVector<std::size_t> first_green;
  LargeVector<double> radius, tension, of_load, of_facet, of_work;
  LargeVector<float> slope_of_load, bend;
  // by place
  LargeVector<int> seats;
  LargeVector<double> normals[3], force, response, indentations, turns[3];
  LargeVector<float> rounded, compliance, product, green, d_green, scratch;
  deformable::DropletArrays arrays();

  // by pair. The sides of a pair are places; of a wall the second one has no indentation.
  LargeVector<int> sides[2];
  LargeVector<double> residuals;
  LargeVector<float> softness, unit;    // of a force alone, see alone()
  // weight: 1/(C_i + C_j), 0 where a pair takes no part; moved: by pairs alone, which forces have already; left: of residuals
  LargeVector<float> weight, step, moved, left, direction, change;

  double rounding = 0.0;    // of forces, by steps in single precision
  struct State {
    double imbalance = 0.0, force = 0.0;    // the largest ones
    bool switches = false;                  // pairs open or close, or change by much of their force
    bool balanced(double tolerance) const { return imbalance <= tolerance * force; }
  };
  State last;
  double alone(int k, double residual, double logarithm) const;
  double load_logarithm(int k) const;
  double most_force(int k, double before) const;
  // A step by so much of the force is far from linear.
  static bool is_bent(double force, double step) { return std::fabs(step) > 0.05 * force; }
  void agree();
  double precision() const;
  State evaluate();
  State after_step(const State &before);
  State look();
  void move_alone(int k, double next, double own_compliance);
  void open_alone(int k, double residual);
  void switch_pairs();
  void multiply(const LargeVector<float> &step);
  float product_of(int k) const { return product[sides[0][k]] + product[sides[1][k]]; }
  void correct(const State &);
  double conjugate_gradients(double accuracy, double start = 0.0);
  double force_after(int k) const;
  void bend_steps();
  void relax();
  void take_steps();
  State search(State now, const State &before, double along);
  double slope() const;
  void sum(double *values, int count, MPI_Op) const;
};

}    // namespace LAMMPS_NS

#endif
