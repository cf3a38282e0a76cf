#include "force_loops.h"

#include "vector_loops.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

DEFORMABLE_CLONES Largest LAMMPS_NS::find_residuals(const ForceLoop &p, int begin, int end)
{
  const double *const overlap = p.overlap, *const stiffening = p.stiffening, *const force = p.force;
  const double *const indentation = p.indentation, *const compliance = p.compliance;
  const int *const first = p.first, *const second = p.second;
  double *const residual = p.residual, *const error = p.error, *const weight = p.weight;
  double worst = 0.0, largest = 0.0;
#pragma omp simd reduction(max : worst, largest)
  for (int k = begin; k < end; ++k) {
    // the sum of both sides first: the same to the last bit on the other rank
    const double r = overlap[k] - (indentation[first[k]] + indentation[second[k]]), f = force[k];
    const double w = 1.0 / (compliance[first[k]] + compliance[second[k]]);
    const double linear = r * w, cubic = stiffening[k] * r * r * r;
    const bool counts = f > 0.0 || r > 0.0, takes_part = f + linear > 0.0;
    const double more = linear > cubic ? linear : cubic;    // r > 0
    const double less = linear < cubic ? linear : cubic;    // r <= 0, f = 0
    const double loss = linear > -f ? linear : -f;          // r <= 0, f > 0
    const double e = r > 0.0 ? more : f > 0.0 ? loss : less;
    residual[k] = r;
    weight[k] = takes_part ? w : 0.0;
    error[k] = e;
    const double size = counts ? std::fabs(e) : 0.0;
    worst = size > worst ? size : worst;
    largest = f > largest ? f : largest;
  }
  return {worst, largest};
}

DEFORMABLE_CLONES double LAMMPS_NS::begin_gradients(const ForceLoop &p, int begin, int end)
{
  const double *const residual = p.residual, *const weight = p.weight;
  double *const left = p.left, *const direction = p.direction, *const step = p.step;
  double norm2 = 0.0;
#pragma omp simd reduction(+ : norm2)
  for (int k = begin; k < end; ++k) {
    const double r = residual[k], x = weight[k] * r;
    left[k] = r;
    direction[k] = x;
    step[k] = 0.0;
    norm2 += x * r;
  }
  return norm2;
}

DEFORMABLE_CLONES double LAMMPS_NS::add_products(const ForceLoop &p, int begin, int end)
{
  const double *const by_contact = p.contact_product, *const direction = p.direction;
  const int *const first = p.first, *const second = p.second;
  double *const product = p.product;
  double curvature = 0.0;
#pragma omp simd reduction(+ : curvature)
  for (int k = begin; k < end; ++k) {
    const double y = by_contact[first[k]] + by_contact[second[k]];
    product[k] = y;
    curvature += y * direction[k];
  }
  return curvature;
}

DEFORMABLE_CLONES double LAMMPS_NS::advance(const ForceLoop &p, double length, int begin, int end)
{
  const double *const product = p.product, *const direction = p.direction, *const weight = p.weight;
  double *const left = p.left, *const step = p.step;
  double norm2 = 0.0;
#pragma omp simd reduction(+ : norm2)
  for (int k = begin; k < end; ++k) {
    step[k] += length * direction[k];
    const double r = left[k] - length * product[k];
    left[k] = r;
    norm2 += r * r * weight[k];
  }
  return norm2;
}

DEFORMABLE_CLONES void LAMMPS_NS::turn(const ForceLoop &p, double conjugation, int begin, int end)
{
  const double *const left = p.left, *const weight = p.weight;
  double *const direction = p.direction;
  DEFORMABLE_INDEPENDENT
  for (int k = begin; k < end; ++k) direction[k] = weight[k] * left[k] + conjugation * direction[k];
}

DEFORMABLE_CLONES double LAMMPS_NS::sum(const double *x, int begin, int end)
{
  double total = 0.0;
#pragma omp simd reduction(+ : total)
  for (int k = begin; k < end; ++k) total += x[k];
  return total;
}

DEFORMABLE_CLONES double LAMMPS_NS::dot(const double *x, const double *y, int begin, int end)
{
  double total = 0.0;
#pragma omp simd reduction(+ : total)
  for (int k = begin; k < end; ++k) total += x[k] * y[k];
  return total;
}
