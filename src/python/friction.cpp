#include "python/laws.h"

#include "laws/friction.h"

using namespace deformable;

namespace {

void require(const Friction &c, double dt)
{
  const std::string problem = invalid_friction(c);
  if (!problem.empty()) refuse(problem);
  require_positive("dt", dt);
}

}    // namespace

void deformable::bind_friction(nb::module_ &m)
{
  m.def(
      "rub",
      [](double mu, double kt, double gt, double xi, double way, double dt, double normal) {
        const Friction c = {mu, kt, gt, 0.0};
        require(c, dt);
        const Rub now = rub(c, xi, way, dt, normal);
        return nb::make_tuple(now.xi, now.force, now.slides);
      },
      "mu"_a, "kt"_a, "gt"_a, "xi"_a, "way"_a, "dt"_a, "normal"_a,
      R"(A step of the spring of length xi along a contact whose sides move by `way` against each other.

f = kt xi + gt dxi/dt, held to abs(f) <= mu max(normal, 0); where it slides, dxi/dt = (f - kt xi)/gt. Returns xi and f at the
end of the step, and whether it slides. `normal` is the force that presses then.

Raises
------
ValueError
    A coefficient that is negative or no number, or a step dt that is not positive.)");
  m.def(
      "rub_loss",
      [](double kt, double xi_before, double force_before, double xi, double force, double way) {
        const RubLoss lost = loss(kt, {xi_before, force_before, false}, {xi, force, false}, way);
        return nb::make_tuple(lost.sliding, lost.dashpot);
      },
      "kt"_a, "xi_before"_a, "force_before"_a, "xi"_a, "force"_a, "way"_a,
      R"(Energies that a step loses by sliding, F (way - dxi), and in the dashpot, (F - kt mean(xi)) dxi.

F is the mean force of both ends of the step. With the change of kt xi^2/2 their sum is the work F way.)");
  m.def(
      "contact_damping",
      [](double damp, double way, double dt, double normal) {
        require({0.0, 0.0, 0.0, damp}, dt);
        return damping(damp, way, dt, normal);
      },
      "damp"_a, "way"_a, "dt"_a, "normal"_a,
      R"(Force damp way/dt along the normal, positive where the sides separate, at most max(normal, 0).)");
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
        const std::string problem = invalid_friction({mu, kt, gt, damp});
        return problem.empty() ? nb::none() : nb::object(nb::str(problem.c_str()));
      },
      "mu"_a, "kt"_a, "gt"_a = 0.0, "damp"_a = 0.0,
      R"(The problem of these coefficients in a phrase that names the value, or None.

None of them may be negative; mu may be inf.)");
}
