#include "solver/droplet_solver.h"

#include "laws/droplet_film.h"

#include "atom.h"

#include <algorithm>
#include <cmath>

namespace deformable {

// The bulge of a droplet that no solution has seen, as if facets bore four times half of the overlap as their force.
static constexpr double BULGE_PER_OVERLAP = BULGE_PER_LOAD * 2.0 / (8.0 * PI);

// The forces of droplets have kinks everywhere: a cubic is no worse behind one. Corrections leave out films that turn.
static Tuning tuned_for_droplets()
{
  Tuning t;
  t.smooth = 1e300;
  t.of_lines = 0.015;
  return t;
}

DropletSolver::DropletSolver(LAMMPS *lmp, const BatchKernels &kernels, double tolerance,
                             int max_evaluations)
    : DualSolver(lmp, kernels.forces, true, false, BULGE_PER_OVERLAP, LARGEST_BULGE, tolerance,
                 max_evaluations, tuned_for_droplets()),
      all_kernels(kernels),
      droplets(&kernels.droplets)
{
}

void DropletSolver::use_films()
{
  auto made = std::make_unique<DropletFilms>();
  droplet_films = made.get();
  films = std::move(made);
  droplets = &all_kernels.sticking_droplets;
}

DropletArrays DropletSolver::arrays()
{
  DropletArrays d = {};
  d.tension = tension.data();
  d.film_log = film_log.data();
  d.per_radii = per_radii.data();
  d.load = of_load.data();
  d.facet = of_facet.data();
  d.still_work = still_work.data();
  d.still = still.data();
  d.nx = normals[0].data();
  d.ny = normals[1].data();
  d.nz = normals[2].data();
  d.force = force.data();
  d.tx = facets[0].data();
  d.ty = facets[1].data();
  d.tz = facets[2].data();
  d.damping = damping.data();
  d.torque_x = torques[0].data();
  d.torque_y = torques[1].data();
  d.torque_z = torques[2].data();
  d.taken = taken.data();
  d.green = green.data();
  d.green2 = green2.data();
  d.d_green = d_green.data();
  if (droplet_films) droplet_films->add_to(d);
  return d;
}

bool DropletSolver::shape(const RingBatches &batch)
{
  droplets->shape(batch, arrays(), list.pairs.directions());
  return true;
}

bool DropletSolver::adapt(const RingBatches &batch, const float *, double)
{
  droplets->adapt(batch, arrays(), list.pairs.directions());
  return true;
}

void DropletSolver::turn_facets(const RingBatches &batch)
{
  droplets->turn(batch, arrays());
}

void DropletSolver::exchange_facets()
{
  list.remote_sides.exchange(facets[0].data(), facets[1].data(), facets[2].data(), damping.data());
  if (droplet_films) droplet_films->exchange(list.remote_sides);
}

void DropletSolver::find_slopes(const RingBatches &batch)
{
  droplets->derive(batch, arrays());
}

// Pairs are in units of the largest tension and the smallest radius.
void DropletSolver::set_material(const ForceCall &call, bool arranged)
{
  const std::size_t rows = batches.particle.size(), places = batches.contacts;
  if (arranged) {
    batches.set_kind(true, false, {});
    tension.assign(rows, 1.0);
    for (auto *const v : {&of_load, &of_facet, &still_work}) v->assign(rows, 0.0);
    for (auto *const v : {&film_log, &per_radii, &still, &force}) v->assign(places, 0.0);
    for (int axis = 0; axis < 3; ++axis) {
      normals[axis].assign(places, 0.0);
      torques[axis].assign(places, 0.0);
      facets[axis].assign(batches.indentation.size(), 0.0);
    }
    damping.assign(batches.indentation.size(), 0.0);
    taken.assign(places, 0.0F);
    for (auto *const v : {&green, &green2, &d_green}) v->resize(batches.green.size());
    std::fill(batches.per_pressure.begin(), batches.per_pressure.end(), 1.0);
  }
  double largest = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const int i = batches.particle[row];
    if (i < 0) continue;
    batches.radius[row] = call.radius[i];
    tension[row] = call.materials->stiffness_of(i, call.radius[i]).tension;
    batches.per_pressure[row] = 1.0 / tension[row];
    largest = std::max(largest, tension[row]);
  }
  largest = list.remote_sides.largest(largest);
  list.pairs.set_units(largest > 0.0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1.0,
                       std::ldexp(1.0, std::ilogb(call.smallest)));
  find_films(call);
  if (!list.pairs.adhesive) return;
  find_adhesions(call);
  droplet_films->set_material(call, batches, list.pairs, arranged);
}

// Films between droplets of unlike pressure are curved, and all of them may turn. Walls do neither.
void DropletSolver::find_films(const ForceCall &call)
{
  const NearPairs &pairs = list.pairs;
  const auto tension_of = [&](int i) {
    return call.materials->stiffness_of(i, call.radius[i]).tension;
  };
  for (int k = 0; k < pairs.wall; ++k) {
    const int end[] = {pairs.i[k], pairs.j[k]};
    const double radii = call.radius[end[0]] + call.radius[end[1]];
    for (int side = 0; side < (k < pairs.remote ? 2 : 1); ++side) {
      const int i = end[side], j = end[1 - side], place = pairs.side[side][k];
      per_radii[place] = 1.0 / radii;
      film_log[place] =
          std::log(film_ratio(call.radius[i], tension_of(i), call.radius[j], tension_of(j)));
    }
  }
}

double DropletSolver::bulge_of(std::size_t row, double radius) const
{
  if (!droplet_films) return droplet_bulge(radius, of_load[row]);
  return radius * std::min(droplet_films->bulge(row), LARGEST_BULGE);
}

void DropletSolver::find_bulges(const ForceCall &call)
{
  list.reset_growth();
  largest_bulge = 0.0;
  int too_far = -1;
  for (std::size_t row = 0; row < batches.particle.size(); ++row) {
    const int i = batches.particle[row];
    if (i < 0) continue;
    const double bulge = bulge_of(row, call.radius[i]);
    list.set_bulge(i, bulge);
    largest_bulge = std::max(largest_bulge, bulge / call.radius[i]);
    if (bulge > call.reach * call.radius[i]) too_far = static_cast<int>(row);
  }
  if (too_far < 0) return;
  call.refusals->collect([&] {
    const double x =
        droplet_films ? droplet_films->bulge(too_far) / BULGE_PER_LOAD : of_load[too_far];
    refuse("The load of atom {} is {:.4g}, but 'reach {}' covers loads to {:.4g}: separate "
           "droplets that overlap first, take smaller steps or a smaller timestep, or use a "
           "reach of {:.2g} or more",
           atom->tag[batches.particle[too_far]], x, call.reach, call.reach / BULGE_PER_LOAD,
           std::min(1.2 * BULGE_PER_LOAD * x, LARGEST_BULGE));
  });
}

int DropletSolver::beyond_model()
{
  const DropletArrays of = arrays();
  int count = 0;
  for (std::size_t row = 0; row < batches.particle.size(); ++row) {
    const int i = batches.particle[row];
    if (i < 0) continue;
    count += of_load[row] > LARGEST_LOAD ||
             (droplet_films ? droplet_films->are_beyond(row, batches.count[i], of)
                            : of_facet[row] > LARGEST_FACET);
  }
  return count;
}

Vector3 DropletSolver::tilt(int k) const
{
  const NearPairs &p = list.pairs;
  if (k >= p.wall) return {};
  const auto way = [&](int axis) {
    return p.per_distance[k] * (facets[axis][p.side[1][k]] - facets[axis][p.side[0][k]]);
  };
  return {way(0), way(1), way(2)};
}

// F.a - W
double DropletSolver::energy() const
{
  const NearPairs &p = list.pairs;
  double sum = p.sum([&](int begin, int end) {
    double moment = 0.0;
    for (int k = begin; k < end; ++k)
      moment +=
          p.force[k] * (batches.indentation[p.side[0][k]] + batches.indentation[p.side[1][k]]);
    return moment;
  });
  for (std::size_t row = 0; row < batches.particle.size(); ++row)
    if (batches.particle[row] >= 0) sum -= batches.work[row];
  return sum;
}

double DropletSolver::memory_usage() const
{
  return DualSolver::memory_usage() +
         bytes_of(tension, of_load, of_facet, still_work, film_log, per_radii, still, force,
                  damping, taken, green, green2, d_green, normals[0], normals[1], normals[2],
                  facets[0], facets[1], facets[2], torques[0], torques[1], torques[2]);
}

}    // namespace deformable
