// Loops over pairs, from `begin` to before `end`, for the solution of balanced forces.

#ifndef DEFORMABLE_FORCE_LOOPS_H
#define DEFORMABLE_FORCE_LOOPS_H

namespace LAMMPS_NS {

struct ForceLoop {
  const double *overlap, *stiffening;
  const int *first, *second;                    // contacts of the pairs
  const double *indentation, *compliance;       // by contact
  const double *contact_product;                // C x, by contact
  double *force, *residual, *error, *weight;    // see ForceSolver
  double *step, *left, *direction, *product;
};

struct Largest {
  double error, force;
};

// r, imbalances and weights from the indentations. The largest imbalance and force.
Largest find_residuals(const ForceLoop &, int begin, int end);

// Conjugate gradients: the first direction, the product of both rings, the step along the direction, the next
// direction. Sums of products, in this order: r.w.r, the curvature, left.w.left.
double begin_gradients(const ForceLoop &, int begin, int end);
double add_products(const ForceLoop &, int begin, int end);
double advance(const ForceLoop &, double length, int begin, int end);
void turn(const ForceLoop &, double conjugation, int begin, int end);

double sum(const double *, int begin, int end);
double dot(const double *, const double *, int begin, int end);

}    // namespace LAMMPS_NS

#endif
