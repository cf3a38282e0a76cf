#include "solver/droplet_solver.h"

#include "laws/droplet.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

// Of a droplet that no solution has seen: as of facets with four times half of the overlap as their force.
static constexpr double BULGE_PER_OVERLAP = BULGE_PER_LOAD * 2.0 / (8.0 * PI);

// The forces of droplets have kinks everywhere: a cubic is no worse behind one.
static Tuning tuned_for_droplets()
{
  Tuning t;
  t.smooth = 1e300;
  return t;
}

DropletSolver::DropletSolver(LAMMPS *lmp, const ForceKernels &kernels,
                             const DropletKernels &droplets, double tolerance, int max_evaluations)
    : DualSolver(lmp, kernels, true, false, BULGE_PER_OVERLAP, LARGEST_BULGE, tolerance,
                 max_evaluations, tuned_for_droplets()),
      droplets(droplets)
{
}

DropletArrays DropletSolver::arrays()
{
  return {tension.data(),    of_load.data(),    of_facet.data(), normals[0].data(),
          normals[1].data(), normals[2].data(), force.data(),    response.data(),
          turns[0].data(),   turns[1].data(),   turns[2].data(), d_green.data()};
}

PairForces DropletSolver::forces() const
{
  const NearPairs &p = list.pairs;
  return {p.force.data(), p.nx.data(), p.ny.data(), p.nz.data()};
}

bool DropletSolver::shape(const RingBatches &batch)
{
  droplets.shape(batch, arrays(), forces());
  return true;
}

bool DropletSolver::adapt(const RingBatches &batch, const float *changes, double unit)
{
  droplets.adapt(batch, arrays(), forces(), changes, unit);
  return true;
}

// Pairs are in units of the largest tension and the smallest radius.
void DropletSolver::set_material(const Particles &p, bool arranged)
{
  const std::size_t rows = batches.particle.size(), places = batches.contacts;
  if (arranged) {
    batches.set_kind(true, false, {});
    tension.assign(rows, 1.0);
    for (auto *const v : {&of_load, &of_facet}) v->assign(rows, 0.0);
    for (auto *const v : {&normals[0], &normals[1], &normals[2], &force, &response, &turns[0],
                          &turns[1], &turns[2]})
      v->assign(places, 0.0);
    d_green.resize(batches.green.size());
    std::fill(batches.per_pressure.begin(), batches.per_pressure.end(), 1.0);
  }
  double largest = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const int i = batches.particle[row];
    if (i < 0) continue;
    batches.radius[row] = p.radius[i];
    tension[row] = p.materials->stiffness_of(i, p.radius[i]).tension;
    batches.per_pressure[row] = 1.0 / tension[row];
    largest = std::max(largest, tension[row]);
  }
  largest = list.remote_sides.largest(largest);
  list.pairs.set_units(largest > 0.0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1.0,
                       std::ldexp(1.0, std::ilogb(p.smallest)));
}

void DropletSolver::find_bulges(const Particles &p)
{
  list.reset_growth();
  beyond_model = 0;
  largest_bulge = 0.0;
  int too_far = -1;
  for (std::size_t row = 0; row < batches.particle.size(); ++row) {
    const int i = batches.particle[row];
    if (i < 0) continue;
    const double bulge = droplet_bulge(p.radius[i], of_load[row]);
    list.set_bulge(i, bulge);
    beyond_model += of_load[row] > LARGEST_LOAD || of_facet[row] > LARGEST_FACET;
    largest_bulge = std::max(largest_bulge, bulge / p.radius[i]);
    if (bulge > p.reach * p.radius[i]) too_far = static_cast<int>(row);
  }
  if (too_far < 0) return;
  p.refusals->collect([&] {
    const double x = of_load[too_far];
    refuse("The load of atom {} is {:.4g}, but 'reach {}' covers loads to {:.4g}: separate "
           "droplets that overlap first, take smaller steps or a smaller timestep, or use a "
           "reach of {:.2g} or more",
           atom->tag[batches.particle[too_far]], x, p.reach, p.reach / BULGE_PER_LOAD,
           std::min(1.2 * BULGE_PER_LOAD * x, LARGEST_BULGE));
  });
}

double DropletSolver::energy() const
{
  double sum = 0.0;
  for (std::size_t row = 0; row < batches.particle.size(); ++row)
    if (batches.particle[row] >= 0) sum -= batches.work[row];
  return sum;
}

void DropletSolver::warn(const Particles &, bool)
{
  if (are_balanced || warned) return;
  warned = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Contacts are not balanced: after {} evaluations forces are off by up to {:.2g} "
                   "of the largest, with a tolerance of {:.2g}. {} (pair_style deformable/droplet "
                   "balance)",
                   summary.evaluations, summary.imbalance, tolerance, summary.why());
}

double DropletSolver::memory_usage() const
{
  return DualSolver::memory_usage() + bytes_of(tension, of_load, of_facet, normals[0], normals[1],
                                               normals[2], force, response, turns[0], turns[1],
                                               turns[2], d_green);
}
