// Parts of src/solver, one by one, for tests (DEFORMABLE_FOR_TESTS). The symbols of LAMMPS must be there before Python loads it.

#include "python/arguments.h"

#include "kernels/batch_kernels.h"
#include "solver/block_levels.h"
#include "solver/linear_solver.h"
#include "solver/pair_list.h"
#include "solver/pair_relaxation.h"
#include "solver/remote_sides.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "lammps.h"
#include "neighbor.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

using namespace deformable;

namespace {

using Numbers = std::vector<double>;

const ForceKernels &kernels()
{
  return batch_kernels("")->forces;
}

LAMMPS *lammps_of(nb::handle lmp)    // of an object of Python
{
  return reinterpret_cast<LAMMPS *>(nb::cast<std::uintptr_t>(lmp.attr("lmp").attr("value")));
}

/* ----------------------------------------------------------------------
   Rings of radius 1 with straight contact lines, and what DualSolver has of
   them. Second ones of pairs: rings, then ghosts, whose numbers are n and
   larger, then walls, which are negative.
------------------------------------------------------------------------- */

struct Rings {
  NearPairs pairs;
  ContactBatches batches;
  LargeVector<float> residual, weight, step;

  Rings(const Numbers &kA, double kP, const std::vector<int> &first, const std::vector<int> &second,
        const Numbers &angle)
  {
    const int n = static_cast<int>(kA.size());
    int all = n;
    for (std::size_t k = 0; k < first.size(); ++k) {
      pairs.remote += second[k] >= 0 && second[k] < n;
      pairs.wall += second[k] >= 0;
      pairs.add(first[k], second[k], {});
      all = std::max(all, second[k] + 1);
    }
    pairs.make_room();
    std::vector<int> order(n);
    std::vector<tagint> tags(all);
    for (int i = 0; i < all; ++i) {
      pairs.owned.push_back(i < n ? i : -1);
      if (i < n) order[i] = i;
      tags[i] = i + 1;
    }
    for (int k = 0; k < pairs.size; ++k) {
      pairs.angle[k] = angle[k];
      pairs.nx[k] = std::cos(angle[k]);
      pairs.ny[k] = std::sin(angle[k]);
    }
    batches.arrange(order.data(), n, n, pairs, tags.data(), false);
    const Stiffness some = {kA[0], kP};
    ContactBatches::Members given = {};
    for (int m = 0; m < MEMBERS; ++m)
      given[m] = some.*PARAMETERS[m].of_ring != Stiffness().*PARAMETERS[m].of_ring;
    batches.set_kind(!some.conserves_perimeter(), false, given);
    for (int i = 0; i < n; ++i) batches.set_stiffness(batches.place[i], {kA[i], kP});
    for (LargeVector<float> *v : {&residual, &weight, &step}) v->assign(pairs.size + 1, 0.0F);
  }

  PairArrays arrays()
  {
    PairArrays a = {};
    a.overlap = pairs.overlap.data();
    a.stiffening = pairs.stiffening.data();
    for (int end = 0; end < 2; ++end) a.side[end] = pairs.side[end].data();
    a.indentation = batches.indentation.data();
    a.compliance = batches.compliance.data();
    a.correction = batches.step.data();
    a.force = pairs.force.data();
    a.residual = residual.data();
    a.weight = weight.data();
    a.step = step.data();
    a.length = pairs.length;
    a.unit = pairs.unit();
    return a;
  }

  bool shape(const Numbers &force)
  {
    std::copy(force.begin(), force.end(), pairs.force.begin());
    return kernels().shape(batches.arrays(), pairs.directions());
  }
  double find_residuals(const Numbers &overlap)
  {
    std::copy(overlap.begin(), overlap.end(), pairs.overlap.begin());
    return pairs.sum(
        [&](int begin, int end) { return kernels().find_residuals(arrays(), begin, end).norm2; });
  }
};

void bind_rings(nb::module_ &m)
{
  const auto of_pairs = [](auto &&value) {
    return [value](const Rings &r) {
      return per_contact(r.pairs.size, [&](std::size_t k) { return value(r, k); });
    };
  };
  // of the first or second contact of a pair, which has only one with a ghost or a wall
  const auto correction = [&](int side) {
    return of_pairs([side](const Rings &r, int k) {
      return r.batches.step[r.pairs.side[k < r.pairs.remote ? side : 0][k]];
    });
  };
  const auto move = nb::rv_policy::move;
  nb::class_<Rings>(m, "Rings")
      .def(nb::init<Numbers, double, std::vector<int>, std::vector<int>, Numbers>(), "kA"_a, "kP"_a,
           "first"_a, "second"_a, "angle"_a)
      .def("shape", &Rings::shape, "force"_a)
      .def("find_residuals", &Rings::find_residuals, "overlap"_a, "Returns norm2, see Residuals.")
      .def_prop_ro("force", of_pairs([](const Rings &r, int k) { return r.pairs.force[k]; }), move)
      .def_prop_ro("residual", of_pairs([](const Rings &r, int k) { return r.residual[k]; }), move)
      .def_prop_ro("weight", of_pairs([](const Rings &r, int k) { return r.weight[k]; }), move)
      .def_prop_ro("step", of_pairs([](const Rings &r, int k) { return r.step[k]; }), move)
      .def_prop_ro("indentation", of_pairs([](const Rings &r, int k) {
                     return r.batches.indentation[r.pairs.side[0][k]] +
                            r.batches.indentation[r.pairs.side[1][k]];
                   }),
                   move)
      .def_prop_ro("first_correction", correction(0), move)
      .def_prop_ro("second_correction", correction(1), move)
      .def_prop_ro(
          "batch",
          [](const Rings &r) {
            return per_contact(r.batches.place.size(),
                               [&](std::size_t i) { return r.batches.place[i] / LANES; });
          },
          move);
}

struct Linear {
  Rings &rings;
  const Tuning tuning;
  RemoteSides remote;
  LinearSolver solver;

  Linear(Rings &rings, nb::handle lmp, const std::string &tuned)
      : rings(rings),
        tuning(Tuning().changed_by(tuned)),
        remote(lammps_of(lmp)),
        solver(kernels(), tuning)
  {
  }
  int begin(double norm2, double accuracy)
  {
    return solver.begin(rings.batches, remote, rings.arrays(), norm2, accuracy);
  }
  void iterate(int last)
  {
    for (int k = 1; k <= last; ++k) solver.iterate(rings.batches.arrays(), rings.arrays(), k, last);
  }
};

void bind_linear(nb::module_ &m)
{
  nb::class_<Linear>(m, "LinearSolver")
      .def(nb::init<Rings &, nb::handle, std::string>(), "rings"_a, "lmp"_a, "tuning"_a = "",
           nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>())
      .def("begin", &Linear::begin, "norm2"_a, "accuracy"_a)
      .def("plan", [](Linear &s, double accuracy) { return s.solver.plan(accuracy); })
      .def("iterate", &Linear::iterate, "last"_a)
      .def("invalidate_bounds", [](Linear &s) { s.solver.invalidate_bounds(); })
      .def("knows_bounds", [](const Linear &s) { return s.solver.knows_bounds(); })
      .def("is_sound", [](const Linear &s, double slope, double norm2) {
        return s.solver.is_sound(slope, norm2);
      });
}

struct Blocks {
  BlockLevels levels;

  explicit Blocks(const Rings &rings) { levels.arrange(rings.batches, rings.pairs); }
};

void bind_blocks(nb::module_ &m)
{
  nb::class_<Blocks>(m, "BlockLevels")
      .def(nb::init<const Rings &>(), "rings"_a)
      .def("count", [](const Blocks &b) { return b.levels.count(); })
      .def("neighbors",
           [](const Blocks &b, int block) {
             std::vector<int> found;
             b.levels.for_neighbors(block, [&](int other) { found.push_back(other); });
             return found;
           })
      .def("pairs",
           [](const Blocks &b, int block) {
             std::vector<std::tuple<int, int, double>> found;
             b.levels.for_pairs(block, [&](int begin, int end, double part) {
               found.emplace_back(begin, end, part);
             });
             return found;
           })
      .def("batches",
           [](const Blocks &b, int block) {
             RingBatches rings = {};
             b.levels.choose(rings, block);
             return std::pair(rings.begin, rings.end);
           })
      .def(
          "run",
          [](Blocks &b, int last, const nb::callable &work, const nb::callable &exchange,
             int number) {
            Threads threads;
            threads.set_count(number);
            const nb::gil_scoped_release let_others;
            b.levels.run(
                threads, last,
                [&](int block, int iteration, int /*thread*/) {
                  const nb::gil_scoped_acquire alone;
                  work(block, iteration);
                },
                [&](int iteration) {
                  const nb::gil_scoped_acquire alone;
                  exchange(iteration);
                });
          },
          "last"_a, "work"_a, "exchange"_a, "threads"_a = 1);
}

struct Relaxation {
  Rings &rings;
  const Tuning tuning;
  BlockLevels levels;
  PairRelaxation relaxation;

  Relaxation(Rings &rings, const std::string &tuned)
      : rings(rings),
        tuning(Tuning().changed_by(tuned))
  {
    levels.arrange(rings.batches, rings.pairs);
    relaxation.arrange(rings.batches, rings.pairs);
  }
  void relax(int block)
  {
    relaxation.relax(block, kernels(), levels, rings.pairs, rings.batches, rings.arrays());
  }
  std::vector<int> changed(int block)
  {
    std::vector<int> found;
    RingBatches here = rings.batches.arrays();
    levels.choose(here, block);
    relaxation.for_changed(here, [&](const RingBatches &batch) {
      for (int b = batch.begin; b < batch.end; ++b) found.push_back(b);
    });
    return found;
  }
};

void bind_relaxation(nb::module_ &m)
{
  nb::class_<Relaxation>(m, "PairRelaxation")
      .def(nb::init<Rings &, std::string>(), "rings"_a, "tuning"_a = "", nb::keep_alive<1, 2>())
      .def(
          "begin",
          [](Relaxation &r, double tolerance, double largest_force) {
            return r.relaxation.begin(r.tuning, tolerance, largest_force);
          },
          "tolerance"_a, "largest_force"_a)
      .def("relax", &Relaxation::relax, "block"_a)
      .def("changed", &Relaxation::changed, "block"_a);
}

/* ----------------------------------------------------------------------
   Pairs of a LAMMPS
------------------------------------------------------------------------- */

using Past = std::array<std::array<double, 4>, KINDS>;    // of each kind: last, earlier
using Place3 = std::array<double, 3>;

PairPast past_of(const Past &given)
{
  PairPast past;
  for (int kind = 0; kind < KINDS; ++kind) {
    past.of[kind].last = given[kind][0];
    std::copy_n(&given[kind][1], 3, past.of[kind].earlier);
  }
  return past;
}

Past numbers_of(const PairPast &past)
{
  Past found;
  for (int kind = 0; kind < KINDS; ++kind) {
    found[kind][0] = past.of[kind].last;
    std::copy_n(past.of[kind].earlier, 3, &found[kind][1]);
  }
  return found;
}

void bind_history(nb::module_ &m)
{
  nb::class_<PairHistory>(m, "PairHistory")
      .def(nb::init<>())
      .def("add", [](PairHistory &h, tagint tag, tagint partner, const Place3 &x,
                     const Past &past) { h.add(tag, partner, {x[0], x[1], x[2]}, past_of(past)); })
      .def("add_bulge", &PairHistory::add_bulge)
      .def("sort", &PairHistory::sort)
      .def("find",
           [](const PairHistory &h, tagint tag, tagint partner, const Place3 &x) {
             return numbers_of(h.find(tag, partner, {x[0], x[1], x[2]}));
           })
      .def("bulge", &PairHistory::bulge);
}

// Of the first neighbor list, with the radii of atoms. The words of each wall are those behind the style of its fix.
struct List {
  const Tuning tuning;
  LAMMPS *const lmp;
  const double smallest, reach;
  std::vector<std::unique_ptr<FixDeformableWall>> own;
  std::vector<FixDeformableWall *> walls;
  Refusals refusals;
  PairList list;
  Threads threads;

  List(nb::handle given, bool curved, double smallest, double reach,
       const std::vector<std::vector<std::string>> &walls_by_words, const std::string &tuned)
      : tuning(Tuning().changed_by(tuned)),
        lmp(lammps_of(given)),
        smallest(smallest),
        reach(reach),
        refusals(lmp),
        list(lmp, kernels(), tuning, lmp->domain->dimension == 3, curved, 0.0, 1.0)
  {
    for (const std::vector<std::string> &given : walls_by_words) {
      std::vector<std::string> words = {"wall", "all", "deformable/wall"};
      words.insert(words.end(), given.begin(), given.end());
      std::vector<char *> arg;
      for (std::string &word : words) arg.push_back(word.data());
      own.push_back(std::make_unique<FixDeformableWall>(lmp, arg.size(), arg.data()));
      walls.push_back(own.back().get());
    }
  }
  List(const List &) = delete;

  ForceCall call(bool new_list)
  {
    ForceCall c;
    c.list = lmp->neighbor->lists[0];
    c.radius = lmp->atom->radius;
    c.walls = &walls;
    c.reach = reach;
    c.smallest = smallest;
    c.new_list = new_list;
    c.refusals = &refusals;
    return c;
  }
  int build(bool new_list)
  {
    const ForceCall c = call(new_list);
    if (!new_list) lmp->comm->forward_comm();
    list.build(c, new_list);
    return list.locate(c, threads);
  }
  bool is_sufficient()
  {
    bool refused = false;
    return list.is_sufficient(call(false), threads, refused);
  }
};

void bind_list(nb::module_ &m)
{
  nb::class_<List>(m, "PairList")
      .def(nb::init<nb::handle, bool, double, double, std::vector<std::vector<std::string>>,
                    std::string>(),
           "lmp"_a, "curved"_a, "smallest"_a, "reach"_a,
           "walls"_a = std::vector<std::vector<std::string>>{}, "tuning"_a = "",
           nb::keep_alive<1, 2>())
      .def("build", &List::build, "new_list"_a)
      .def("is_sufficient", &List::is_sufficient)
      .def("set_bulges",
           [](List &l, const Numbers &bulge) {
             l.list.reset_growth();
             for (std::size_t i = 0; i < bulge.size(); ++i)
               l.list.set_bulge(static_cast<int>(i), bulge[i]);
           })
      .def_prop_ro("segments",
                   [](const List &l) {
                     const NearPairs &p = l.list.pairs;
                     return std::tuple(p.remote, p.wall, p.size);
                   })
      .def_prop_ro("pairs",
                   [](const List &l) {
                     const NearPairs &p = l.list.pairs;
                     const Atom *const atom = l.lmp->atom;
                     std::vector<std::tuple<tagint, tagint, Place3, double>> found;
                     for (int k = 0; k < p.size; ++k) {
                       const double d = k < p.wall ? 1.0 / p.per_distance[k] : 0.0;
                       const Vector3 n = p.normal(k);
                       found.emplace_back(atom->tag[p.i[k]],
                                          k < p.wall ? atom->tag[p.j[k]] : p.j[k],
                                          Place3{d * n.x, d * n.y, d * n.z}, p.overlap[k]);
                     }
                     return found;
                   })
      .def_prop_rw(
          "past",
          [](const List &l) {
            std::vector<Past> found;
            for (int k = 0; k < l.list.pairs.size; ++k)
              found.push_back(numbers_of(l.list.pairs.past_of(k)));
            return found;
          },
          [](List &l, const std::vector<Past> &given) {
            NearPairs &p = l.list.pairs;
            for (int k = 0; k < p.size; ++k)
              for (int kind = 0; kind < p.kinds(); ++kind) {
                p.past[kind].last[k] = given[k][kind][0];
                for (int n = 0; n < 3; ++n)
                  p.past[kind].earlier[n][k] =
                      static_cast<float>(given[k][kind][n + 1] / p.unit(kind));
              }
          });
}

struct Remote {
  RemoteSides sides;
  std::vector<int> contacts;

  explicit Remote(nb::handle lmp) : sides(lammps_of(lmp)) {}
};

void bind_remote(nb::module_ &m)
{
  using Candidate = std::tuple<int, int, int, Place3, Past>;
  nb::class_<Remote>(m, "RemoteSides")
      .def(nb::init<nb::handle>(), "lmp"_a, nb::keep_alive<1, 2>())
      .def("match",
           [](Remote &r, const std::vector<Candidate> &given) {
             std::vector<RemoteSides::Candidate> candidates;
             for (const auto &[i, j, rank, x, past] : given)
               candidates.push_back({i, j, rank, {x[0], x[1], x[2]}, past_of(past)});
             r.sides.match(candidates);
             std::vector<Candidate> kept;
             for (const RemoteSides::Candidate &c : candidates)
               kept.emplace_back(c.i, c.j, c.rank, Place3{c.x.x, c.x.y, c.x.z}, numbers_of(c.past));
             return kept;
           })
      .def("exchange",    // what is behind those of this rank
           [](Remote &r, const std::vector<int> &contacts, Numbers values,
              std::vector<float> others) {
             const std::size_t own = values.size(), all = own + contacts.size();
             r.contacts = contacts;
             r.sides.arrange(r.contacts.data(), static_cast<int>(own));
             values.resize(all);
             others.resize(all);
             r.sides.exchange(values.data(), others.data());
             return std::pair(Numbers(values.begin() + own, values.end()),
                              std::vector<float>(others.begin() + own, others.end()));
           })
      .def("to_ghosts",
           [](Remote &r, Numbers by_particle) {
             r.sides.to_ghosts(by_particle);
             return by_particle;
           })
      .def("sum", [](const Remote &r, double x) { return r.sides.sum(x); })
      .def("largest", [](const Remote &r, double x) { return r.sides.largest(x); })
      .def("all_ranks_sufficient", [](const Remote &r, bool sufficient, bool refused) {
        const bool all = r.sides.all_ranks_sufficient(sufficient, refused);
        return std::pair(all, refused);
      });
}

}    // namespace

NB_MODULE(solver_for_tests, m)
{
  m.doc() = "Parts of the solver of lammps-deformable, which only its tests call.";
  bind_rings(m);
  bind_linear(m);
  bind_blocks(m);
  bind_relaxation(m);
  bind_history(m);
  bind_list(m);
  bind_remote(m);
}
