// The places of the contacts of all droplets.

#include "solver/droplet_solver.h"

#include "atom.h"
#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::LANES;

// Droplets with equal numbers of contacts share a batch. They are sorted within blocks only, so that neighbors stay close in
// memory.
void DropletSolver::sort(const NeighList *list)
{
  constexpr int BLOCK = 128;
  const DropletPairs &p = *pairs;
  std::vector<int> count(atom->nlocal, 0);
  for (int k = 0; k < p.size; ++k) {
    ++count[p.i[k]];
    if (k < p.remote) ++count[p.second(k)];
  }
  std::vector<int> order(list->ilist, list->ilist + list->inum);
  for (std::size_t begin = 0; begin < order.size(); begin += BLOCK)
    std::stable_sort(order.begin() + begin, order.begin() + std::min(begin + BLOCK, order.size()),
                     [&](int a, int b) { return count[a] < count[b]; });
  rows.assign(atom->nlocal, -1);
  for (std::size_t n = 0; n < order.size(); ++n) rows[order[n]] = static_cast<int>(n);

  batches = (list->inum + LANES - 1) / LANES;
  first.resize(batches + 1);
  first_green.resize(batches + 1);
  first[0] = 0;
  first_green[0] = 0;
  longest = 0;
  for (int b = 0; b < batches; ++b) {
    int most = 0;
    for (int n = b * LANES; n < std::min((b + 1) * LANES, list->inum); ++n)
      most = std::max(most, count[order[n]]);
    first[b + 1] = first[b] + most;
    first_green[b + 1] = first_green[b] + static_cast<std::size_t>(most) * (most - 1) / 2;
    longest = std::max(longest, most);
  }
}

void DropletSolver::arrange(const DropletScene &scene, DropletList &list)
{
  pairs = &list.pairs;
  remote = &list.remote_sides;
  const DropletPairs &p = *pairs;
  sort(scene.list);

  const int droplets = batches * LANES, places = first[batches] * LANES,
            remotes = p.wall - p.remote, none = places + remotes;
  seats.assign(places, 2 * p.size);
  for (auto &side : sides) side.assign(p.size, none);
  contacts.assign(droplets, 0);
  const auto sit = [&](int k, int side, int i) {
    const int at = place_of(rows[i], contacts[rows[i]]++);
    seats[at] = 2 * k + side;
    sides[side][k] = at;
  };
  // first those that bear a force: kernels end at the last contact of a batch whose force changes
  for (const bool bears : {true, false})
    for (int k = 0; k < p.size; ++k) {
      if ((p.past[k] > 0.0) != bears) continue;
      sit(k, 0, p.i[k]);
      if (k < p.remote) sit(k, 1, p.second(k));
      if (k >= p.remote && k < p.wall) sides[1][k] = places + k - p.remote;
    }

  for (auto *const v : {&of_load, &of_facet, &of_work}) v->resize(droplets);
  for (auto *const v : {&radius, &tension}) v->assign(droplets, 1.0);
  for (auto *const v : {&slope_of_load, &bend}) v->resize(droplets);
  for (auto *const v :
       {&normals[0], &normals[1], &normals[2], &force, &response, &turns[0], &turns[1], &turns[2]})
    v->resize(places);
  indentations.assign(none + 1, 0.0);
  for (auto *const v : {&compliance, &product}) v->assign(none + 1, 0.0f);
  rounded.resize(places);
  for (auto *const v : {&green, &d_green}) v->resize(first_green[batches] * LANES);
  scratch.resize(static_cast<std::size_t>(deformable::DropletKernels::SCRATCH) * longest * LANES);
  residuals.resize(p.size);
  // one more than pairs: that of empty places
  for (auto *const v : {&softness, &unit, &weight, &step, &moved, &left, &direction, &change})
    v->assign(p.size + 1, 0.0f);
  set_material(scene);
}

void DropletSolver::set_material(const DropletScene &scene)
{
  const DropletPairs &p = *pairs;
  const auto tension_of = [&](int i) {
    return scene.materials->stiffness_of(i, scene.radius[i]).tension;
  };
  for (int ii = 0; ii < scene.list->inum; ++ii) {
    const int i = scene.list->ilist[ii];
    radius[rows[i]] = scene.radius[i];
    tension[rows[i]] = tension_of(i);
  }
  constexpr double PER_TENSION = 0.25 / deformable::PI;
  for (int k = 0; k < p.size; ++k) {
    const int i = p.i[k], j = k < p.wall ? p.j[k] : i;
    const double of_i = tension_of(i), of_j = tension_of(j);
    const double soft = 1.0 / of_i + (k < p.wall ? 1.0 / of_j : 0.0);
    softness[k] = static_cast<float>(PER_TENSION * soft);
    // both logarithms of f, each with its softness, are that of F x unit
    const double log_i = std::log(of_i * scene.radius[i]), log_j = std::log(of_j * scene.radius[j]);
    unit[k] = static_cast<float>(std::exp(-(log_i * of_j + log_j * of_i) / (of_i + of_j)));
  }
}

deformable::DropletArrays DropletSolver::arrays()
{
  return {first.data(),        first_green.data(), radius.data(),     tension.data(),
          of_load.data(),      of_facet.data(),    of_work.data(),    slope_of_load.data(),
          bend.data(),         seats.data(),       normals[0].data(), normals[1].data(),
          normals[2].data(),   force.data(),       rounded.data(),    response.data(),
          indentations.data(), turns[0].data(),    turns[1].data(),   turns[2].data(),
          compliance.data(),   green.data(),       d_green.data(),    scratch.data()};
}

double DropletSolver::memory_usage() const
{
  return bytes_of(rows, first, contacts, first_green, radius, tension, of_load, of_facet, of_work,
                  slope_of_load, bend, seats, normals[0], normals[1], normals[2], force, response,
                  indentations, turns[0], turns[1], turns[2], rounded, compliance, product, green,
                  d_green, scratch, sides[0], sides[1], residuals, softness, unit, weight, step,
                  moved, left, direction, change);
}
