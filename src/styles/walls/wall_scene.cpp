#include "styles/walls/wall_scene.h"

#include "solver/vector_bytes.h"

#include <algorithm>
#include <limits>
#include <map>

using namespace LAMMPS_NS;
using deformable::Edge;
using deformable::HalfPlane;

/* ---------------------------------------------------------------------- */

std::string WallScene::assign(WallSources &&given_sources)
{
  sources = std::move(given_sources);
  walls.clear();
  int features_so_far = 0, edges_so_far = 0;
  for (int w = 0; w < static_cast<int>(sources.walls.size()); ++w) {
    const WallSource &source = sources.walls[w];
    const bool polygon = source.kind == WallSource::POLYGON;
    const int sides = polygon ? static_cast<int>(source.sides.size()) : 0;
    walls.push_back({source.kind, w, features_so_far, edges_so_far, sides, {}, 0, 0, 0, 0});
    features_so_far += polygon ? 3 * sides : 1;
    edges_so_far += sides;
  }
  edges.resize(edges_so_far);
  planes.resize(edges_so_far);
  moving = sources.move();
  if (moving) {
    features.resize(features_so_far);
    before.resize(features_so_far);
    motions.assign(sources.shapes.size(), Motion{});
    loads.assign(features_so_far, Load{});
  }
  const std::string problem = update();
  before = features;
  motions_before = motions;
  return problem;
}

/* ----------------------------------------------------------------------
   LAMMPS rotates a region about a point first, then it moves it.
------------------------------------------------------------------------- */

HalfPlane WallScene::present(const WallSource::Side &side) const
{
  const WallShape &shape = sources.shapes[side.shape];
  HalfPlane plane = shape.planes[side.plane];
  if (shape.region && shape.region->dynamic) {
    double x = plane.offset * plane.nx, y = plane.offset * plane.ny;
    move_with(shape.region, x, y);
    const double angle = angle_of_rotation(shape.region), c = std::cos(angle), s = std::sin(angle);
    const double nx = c * plane.nx - s * plane.ny, ny = s * plane.nx + c * plane.ny;
    plane = {nx, ny, nx * x + ny * y};
  }
  if (side.reversed) plane = {-plane.nx, -plane.ny, -plane.offset};
  return plane;
}

/* ---------------------------------------------------------------------- */

int WallScene::first_outside(int axis, double low, double high) const
{
  bool any_face = false;
  for (const Wall &wall : walls) any_face |= wall.kind == WallSource::FACE;
  for (const Wall &wall : walls) {
    const double n = axis == 0 ? wall.line.nx : wall.line.ny, center = axis == 0 ? wall.x : wall.y;
    if (wall.kind == WallSource::FACE && std::fabs(n) == 1.0 && std::isfinite(wall.line.offset) &&
        (n > 0.0 ? wall.line.offset > high : -wall.line.offset < low))
      return wall.source;
    if (wall.kind == WallSource::RIM && !any_face &&
        (center - wall.radius < low || center + wall.radius > high))
      return wall.source;
  }
  return -1;
}

/* ---------------------------------------------------------------------- */

std::string WallScene::update()
{
  for (WallShape &shape : sources.shapes) {
    if (!shape.region) continue;
    if (shape.region->dz != 0.0 && shape.region->moveflag)
      return "region '" + shape.name + "' leaves the xy plane: it must not move along z";
    if (!shape.region->varshape) continue;
    const std::size_t faces = shape.planes.size();
    const std::string problem = read_shape(shape.region, 0.0, 0.0, shape);
    if (!problem.empty()) return "region '" + shape.name + "' " + problem;
    if (shape.planes.size() != faces) return "region '" + shape.name + "' gains or loses a face";
  }
  for (Wall &wall : walls) {
    const WallSource &source = sources.walls[wall.source];
    if (wall.kind == WallSource::FACE) {
      wall.line = present(source.sides[0]);
    } else if (wall.kind == WallSource::POLYGON) {
      for (int k = 0; k < wall.edges; ++k) planes[k] = present(source.sides[k]);
      if (!deformable::intersect(planes.data(), wall.edges, &edges[wall.first_edge]))
        return "obstacle '" + source.name + "' has no surface: its planes leave nothing of it";
      find_middle(wall);
    } else {
      const WallShape &shape = sources.shapes[source.shape];
      wall.x = shape.x;
      wall.y = shape.y;
      wall.radius = wall.bound = shape.radius;
      if (shape.region && shape.region->dynamic) move_with(shape.region, wall.x, wall.y);
    }
  }
  if (moving) {
    place_features();
    for (std::size_t s = 0; s < motions.size(); ++s) motions[s] = motion_of(sources.shapes[s]);
  }
  return "";
}

/* ----------------------------------------------------------------------
   A circle around a polygon: about the middle of its corners.
------------------------------------------------------------------------- */

void WallScene::find_middle(Wall &wall) const
{
  const Edge *const first = &edges[wall.first_edge];
  double x = 0.0, y = 0.0, square = 0.0;
  int n = 0;
  bool bounded = true;
  for (const Edge *edge = first; edge != first + wall.edges; ++edge) {
    if (!edge->bounds()) continue;
    bounded = bounded && edge->ends();
    x += edge->x(edge->high);
    y += edge->y(edge->high);
    ++n;
  }
  wall.x = wall.y = 0.0;
  wall.bound = std::numeric_limits<double>::infinity();
  if (!bounded) return;
  wall.x = x / n;
  wall.y = y / n;
  for (const Edge *edge = first; edge != first + wall.edges; ++edge) {
    if (!edge->bounds()) continue;
    for (const double end : {edge->low, edge->high}) {
      const double dx = edge->x(end) - wall.x, dy = edge->y(end) - wall.y;
      square = std::max(square, dx * dx + dy * dy);
    }
  }
  wall.bound = std::sqrt(square);
}

/* ---------------------------------------------------------------------- */

void WallScene::place_features()
{
  const auto face = [](const HalfPlane &line) -> Feature {
    return {line.offset * line.nx, line.offset * line.ny, line.nx, line.ny, 1.0};
  };
  for (const Wall &wall : walls) {
    Feature *feature = &features[wall.first_feature];
    if (wall.kind == WallSource::FACE)
      *feature = face(wall.line);
    else if (wall.kind != WallSource::POLYGON)
      *feature = {wall.x, wall.y, 1.0, 0.0, wall.radius};
    for (int k = 0; k < wall.edges; ++k) {
      const Edge &edge = edges[wall.first_edge + k];
      *feature++ = face(edge.line);
      for (const double end : {edge.low, edge.high})
        *feature++ = edge.bounds() && std::isfinite(end)
                         ? Feature{edge.x(end), edge.y(end), 1.0, 0.0, 1.0}
                         : Feature{0.0, 0.0, 1.0, 0.0, 1.0};
    }
  }
}

/* ---------------------------------------------------------------------- */

void WallScene::clear_forces()
{
  std::fill(loads.begin(), loads.end(), Load{});
}

// The last one that begins at this feature or before it.
const WallScene::Wall &WallScene::wall_of(int feature) const
{
  return *(std::upper_bound(walls.begin(), walls.end(), feature,
                            [](int f, const Wall &w) { return f < w.first_feature; }) -
           1);
}

std::vector<std::string> WallScene::feature_names() const
{
  std::vector<std::string> names;
  std::map<std::string, int> so_far;    // features of this name
  for (const Wall &wall : walls)
    for (int k = 0; k < std::max(1, 3 * wall.edges); ++k) {
      const std::string &name = sources.walls[wall.source].name;
      names.push_back(name + ", surface " + std::to_string(++so_far[name]));
    }
  return names;
}

void WallScene::add_force(int feature, double fx, double fy, double x, double y, double dx,
                          double dy, double cutoff)
{
  const Wall *const wall = &wall_of(feature);
  if (wall->kind == WallSource::POLYGON || wall->kind == WallSource::DISK) {
    double from_x = x - wall->x,
           from_y = y - wall->y;    // from the image that the particle touches
    wrap(*wall, cutoff, from_x, from_y);
    x = wall->x + from_x;
    y = wall->y + from_y;
  }
  Load &load = loads[feature];
  double px = x - dx - features[feature].x, py = y - dy - features[feature].y;
  if (wall->kind == WallSource::DISK || wall->kind == WallSource::RIM) {    // not turned by forces
    const double to_rim = wall->radius / std::hypot(x - wall->x, y - wall->y);
    px = to_rim * (x - wall->x);
    py = to_rim * (y - wall->y);
  }
  load.fx += fx;
  load.fy += fy;
  load.moment += px * fy - py * fx;
  load.virial += px * fx + py * fy;
}

/* ----------------------------------------------------------------------
   The work of the forces when their contact points move with the features:
   rotated by (c, s), stretched by k and shifted. Sign 1: forward from the
   last place; -1: backward from the present one.
------------------------------------------------------------------------- */

void WallScene::give(double sign)
{
  for (std::size_t f = 0; f < features.size(); ++f) {
    const Load &load = loads[f];
    if (load.fx == 0.0 && load.fy == 0.0) continue;
    const Feature &from = sign > 0.0 ? before[f] : features[f];
    const Feature &to = sign > 0.0 ? features[f] : before[f];
    const double c = from.nx * to.nx + from.ny * to.ny, s = from.nx * to.ny - from.ny * to.nx;
    const double k = from.radius > 0.0 ? to.radius / from.radius : 1.0;
    given += 0.5 * sign *
             (load.fx * (to.x - from.x) + load.fy * (to.y - from.y) + k * s * load.moment +
              (k * c - 1.0) * load.virial);
  }
}

void WallScene::begin_step(bool counts)
{
  counting = counts;
  for (std::size_t f = 0; f < features.size(); ++f)
    if (!std::isfinite(before[f].x) || !std::isfinite(before[f].y)) before[f] = features[f];
  for (std::size_t s = 0; s < motions.size(); ++s)
    if (!std::isfinite(motions_before[s].x) || !std::isfinite(motions_before[s].y))
      motions_before[s] = motions[s];
  if (counting) give(1.0);
  clear_forces();
}

void WallScene::end_step()
{
  if (counting) give(-1.0);
  before = features;
  motions_before = motions;
}

/* ---------------------------------------------------------------------- */

Motion::Way WallScene::way(int feature, double x, double y) const
{
  if (!moving || static_cast<std::size_t>(feature) >= features.size()) return {0.0, 0.0};
  const Wall &wall = wall_of(feature);
  const WallSource &source = sources.walls[wall.source];
  const int side = wall.kind == WallSource::POLYGON ? (feature - wall.first_feature) / 3 : 0;
  const int shape = source.sides.empty() ? source.shape : source.sides[side].shape;
  const Motion::Way way = motions[shape].way_from(motions_before[shape], x, y);
  return {way.x + slide.x, way.y + slide.y};
}

/* ---------------------------------------------------------------------- */

double WallScene::memory_usage() const
{
  return bytes_of(walls, edges, planes, features, before, motions, motions_before, loads);
}
