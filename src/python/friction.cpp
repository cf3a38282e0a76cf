#include "python/laws.h"

#include "laws/friction.h"

using namespace deformable;

void deformable::bind_friction(nb::module_ &m)
{
  m.def(
      "friction_time_step",
      [](double mu, double kt, double gt, double damp, double mass, double lever) {
        const Friction c = {mu, kt, gt, damp};
        const std::string problem = invalid_friction(c);
        if (!problem.empty()) refuse(problem);
        require_positive("mass", mass);
        return largest_time_step(c, mass, lever);
      },
      "mu"_a, "kt"_a, "gt"_a, "damp"_a, "mass"_a, "lever"_a,
      R"(The largest time step of fix deformable/friction for particles of this mass.

kt dt^2 + 2 gt dt = mass/(2 lever) and 2 damp dt = mass/2, with lever = 1 + m R^2/I: 3.5 for spheres, 3 for disks, 1 without
spins. A quarter of what one contact alone is stable with.)");
  m.def(
      "invalid_friction",
      [](double mu, double kt, double gt, double damp) {
        return or_none(invalid_friction({mu, kt, gt, damp}));
      },
      "mu"_a, "kt"_a, "gt"_a = 0.0, "damp"_a = 0.0,
      R"(The problem of these coefficients in a phrase that names the value, or None.

None of them may be negative; mu may be inf.)");
}
