#include "python/laws.h"

#include "laws/proliferation.h"

#include <algorithm>
#include <cmath>

using namespace deformable;

namespace {

void require_as_many(const std::string &one, std::size_t size, const std::string &other,
                     std::size_t others)
{
  if (size != others)
    refuse(one + " and " + other + " must have as many numbers, not " + std::to_string(size) +
           " and " + std::to_string(others));
}

void require_finite(const std::string &name, const double *values, std::size_t size)
{
  if (!std::all_of(values, values + size, [](double x) { return std::isfinite(x); }))
    refuse(name + " must have finite numbers");
}

Vector growth_rates(nb::handle rate, nb::handle pressure, double most)
{
  const std::vector<double> rates = vector_of("rate", rate), p = vector_of("pressure", pressure);
  require_as_many("rate", rates.size(), "pressure", p.size());
  if (!(most > 0.0)) refuse("most must be above 0, not " + std::to_string(most));
  return per_contact(p.size(), [&](std::size_t i) { return growth_rate(rates[i], p[i], most); });
}

Vector first_shares(double asymmetry, nb::handle u)
{
  const std::vector<double> drawn = vector_of("u", u);
  if (!(asymmetry >= 0.0 && asymmetry < 1.0))
    refuse("asymmetry must be 0 or above and below 1, not " + std::to_string(asymmetry));
  return per_contact(drawn.size(), [&](std::size_t i) { return first_share(asymmetry, drawn[i]); });
}

nb::tuple all_daughters(nb::handle radius, nb::handle share, int dimension)
{
  const std::vector<double> radii = vector_of("radius", radius), shares = vector_of("share", share);
  require_as_many("radius", radii.size(), "share", shares.size());
  if (dimension != 2 && dimension != 3)
    refuse("dimension must be 2 or 3, not " + std::to_string(dimension));
  std::vector<Daughters> found;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (!(radii[i] > 0.0)) refuse("radius must be above 0, not " + std::to_string(radii[i]));
    if (!(shares[i] > 0.0 && shares[i] < 1.0))
      refuse("share must be above 0 and below 1, not " + std::to_string(shares[i]));
    found.push_back(daughters(radii[i], shares[i], dimension));
  }
  const auto each = [&](double Daughters::*member) {
    return per_contact(found.size(), [&](std::size_t i) { return found[i].*member; });
  };
  return nb::make_tuple(each(&Daughters::first), each(&Daughters::second),
                        each(&Daughters::distance));
}

using Tensors = nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

// A row of zeros where there is none.
Matrix stretched_axes(Tensors stress)
{
  const std::size_t d = stress.shape(1);
  if ((d != 2 && d != 3) || stress.shape(2) != d)
    refuse("stress must have the shape (M, 2, 2) or (M, 3, 3)");
  require_finite("stress", stress.data(), stress.size());
  std::vector<double> found;
  for (std::size_t i = 0; i < stress.shape(0); ++i) {
    const auto at = [&](std::size_t a, std::size_t b) {
      return a < d && b < d ? stress.data()[(i * d + a) * d + b] : 0.0;
    };
    const SymmetricTensor s = {at(0, 0), at(1, 1), at(2, 2), at(1, 2), at(0, 2), at(0, 1)};
    const Vector3 axis = stretched_axis(s, static_cast<int>(d)).value_or(Vector3{});
    for (std::size_t a = 0; a < d; ++a) found.push_back(component(axis, static_cast<int>(a)));
  }
  return to_numpy<Matrix>(found.data(), {stress.shape(0), d});
}

Vector long_axis_of(nb::handle outline)
{
  const Table points = table_of("outline", outline, 2);
  const std::size_t size = points.shape(0);
  require_finite("outline", points.data(), points.size());
  SymmetricTensor moments;
  const auto point = [&](std::size_t k) {
    return Vector3{points.data()[2 * k], points.data()[2 * k + 1], 0.0};
  };
  for (std::size_t k = 0; k < size; ++k) add_triangle(moments, point(k), point((k + 1) % size));
  const Vector3 axis = long_axis(moments).value_or(Vector3{});
  const double found[] = {axis.x, axis.y};
  return to_numpy<Vector>(found, {2});
}

}    // namespace

void deformable::bind_proliferation(nb::module_ &m)
{
  m.def("growth_rate", &growth_rates, "rate"_a, "pressure"_a, "most"_a,
        R"(rate max(0, 1 - pressure/most): how fast particles grow, shape (N,) [1/time].

Parameters
----------
rate : (N,)
    Of each particle without contacts [1/time].
pressure : (N,)
    Mean pressure of its contacts [energy/length^d].
most : float
    Pressure at which growth ceases, above 0; may be infinite.

Raises
------
ValueError
    Arrays of different lengths, numbers that are not finite, or a pressure `most` that is not above 0.)");
  m.def("first_share", &first_shares, "asymmetry"_a, "u"_a,
        R"(Shares (1 + asymmetry u)/2 of first daughters, for u drawn between -1 and 1.

Raises
------
ValueError
    An asymmetry below 0, or not below 1.)");
  m.def("daughters", &all_daughters, "radius"_a, "share"_a, "dimension"_a,
        R"(Radii of both daughters of each particle and their distance, of shape (M,) each [length].

Their contact line lies r/2 from the center of the smaller one, in space 4 r/5.

Parameters
----------
radius : (M,)
    Of the mothers [length].
share : (M,)
    Of the size V, pi R^2 or 4 pi R^3/3, that the first daughter has.
dimension : int
    2 or 3.

Raises
------
ValueError
    Arrays of different lengths, a radius that is not above 0, a share that leaves nothing to one of the two, or another
    dimension.)");
  m.def("stretched_axes", &stretched_axes, "stress"_a,
        R"(Axes along which particles are pressed least, or pulled most, shape (M, d).

A row is 0 where all directions are alike.

Parameters
----------
stress : (M, d, d)
    Symmetric, compression positive.

Raises
------
ValueError
    Another shape, or numbers that are not finite.)");
  m.def("long_axis", &long_axis_of, "outline"_a,
        R"(The long axis of an outline by its second moments, shape (2,); 0 if it is round.

Parameters
----------
outline : (m, 2)
    Corners in order, from the center [length].

Raises
------
ValueError
    Another shape, or numbers that are not finite.)");
}
