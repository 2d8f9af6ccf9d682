// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/random.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// Linear light or albedo: r, g, b.
using Color = std::array<float, 3>;

/// How a surface mixes its two albedos; all of them are a few integer operations.
enum class Pattern : std::uint8_t {
  kPlain,   ///< First albedo only.
  kGrain,   ///< Soft value noise.
  kTiles,   ///< Second albedo in the joints.
  kPlanks,  ///< Long boards, each of its own shade.
  kBlocks,  ///< Hard random blocks: posters, books, things seen from afar.
};

/// Looks of a surface.
struct Material {
  Color albedo{0.5f, 0.5f, 0.5f};
  Color second{0.5f, 0.5f, 0.5f};  ///< The pattern's other albedo.
  Pattern pattern = Pattern::kPlain;
  float scale = 1.0f;       ///< Pattern cells per metre.
  Color emission{0, 0, 0};  ///< Radiance, relative units; auto-exposure takes care of the rest.
  int group = 0;            ///< Light group of the emission.
};

/// A flat parallelogram, seen from the side its normal points to (black from behind).
struct Rectangle {
  Eigen::Vector3f corner, edge_u, edge_v;  ///< Earth frame [m].
  Eigen::Vector3f normal;                  ///< Unit.
  Eigen::Vector2f length;                  ///< Length of both edges [m].
  int material = 0;
  int first_node = 0;  ///< Its slot in the light map: (cells_u + 1)(cells_v + 1) nodes, u fastest.
  int cells_u = 1, cells_v = 1;
  bool flat = false;    ///< So small that one value of light does for all nodes.
  int gate = -1;        ///< Index in World::gates; -1: none.
  bool bar = false;     ///< Part of a gate's frame.
  bool closed = false;  ///< Side of a box or pole: from outside the others hide its back.

  [[nodiscard]] int nodes() const { return (cells_u + 1) * (cells_v + 1); }
};

/// Somebody's rectangles in Scene::moved, drawn in the middle of the stretch.
struct Walker {
  world::Person person;
  std::size_t rectangles = 0;
};

/// A world as the camera sees it.
struct Scene {
  std::vector<Material> materials;
  std::vector<Rectangle> fixed;  ///< Same for all seeds; its light is baked.
  std::vector<Rectangle> moved;  ///< Gates, decoys, people; nodes counted from 0 again.
  std::vector<Rectangle>
      solid;  ///< Room, whole obstacles, gates, decoys: what stops a body or a sonar.

  std::vector<Walker> walkers;  ///< Theirs are the last rectangles of `moved` and of `solid`.

  /// The walkers' rectangles as they are at time t [s]: shifted, never turned.
  [[nodiscard]] std::vector<Rectangle> walkers_at(double t) const;
  /// Light-map nodes that a list of rectangles takes.
  [[nodiscard]] static int nodes(const std::vector<Rectangle>& rectangles);
  /// Hash of fixed geometry and all its materials: names the light map's cache file.
  [[nodiscard]] std::uint64_t fixed_hash() const;
};

/// The scene of a world: room, obstacles dressed for `world.look`, clutter, gates, decoys.
///
/// Clutter is generated from fixed random numbers: a room looks the same in every race. It
/// stays inside obstacle footprints, within 0.4 m of the walls, flat on the floor or above 2.6 m.
/// @throws std::invalid_argument for a look that there is not, std::length_error for a room so large
///     that its light map would take more than minutes and half a gigabyte: about 150 x 150 m.
[[nodiscard]] Scene make_scene(const world::World& world);

/// An upright frame on the floor: local a, b horizontal, h height above the floor [m].
struct FloorFrame {
  Eigen::Vector2d origin{0, 0};  ///< Earth frame, north, east [m].
  double heading = 0.0;          ///< Direction of a [rad].
  [[nodiscard]] Eigen::Vector3d at(double a, double b, double h) const;
};

/// Collects rectangles; the looks draw with it.
class SceneBuilder {
 public:
  enum class Layer { kFixed, kMoved, kSolid };

  explicit SceneBuilder(Scene& scene) : scene_{scene} {}

  /// Index of a new material.
  int material(const Material& material);
  /// Index of a new plain or patterned matt material.
  int matt(const Color& albedo, Pattern pattern = Pattern::kPlain, const Color& second = {0, 0, 0},
           double scale = 1.0);
  /// Index of a new light.
  int light(const Color& emission, int group);

  /// Layer of the following rectangles.
  void layer(Layer layer) { layer_ = layer; }
  /// Which gate the following rectangles belong to; -1: none.
  void gate(int gate) { gate_ = gate; }
  /// Whether they are of a gate's coloured frame.
  void bars(bool bars) { bars_ = bars; }
  /// A parallelogram seen from the side of `towards` (a point or direction relative to its centre).
  void rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                 const Eigen::Vector3d& towards, int material);
  /// A box between two corners (a, b, h) of a floor frame, faces outward; none on the floor itself.
  void box(const FloorFrame& frame, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
           int material);
  /// An upright prism of eight sides.
  void pole(const FloorFrame& frame, double diameter, double bottom, double top, int material);
  /// A parallelepiped anywhere in the earth frame: a corner and three edges.
  void block(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
             const Eigen::Vector3d& w, int material);
  /// A thin square bar between two points of the earth frame, open at its ends.
  void bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width, int material);
  /// A prism of eight sides about the line between two points of the earth frame, with lids.
  void tube(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double diameter, int material);
  /// A world's box or pole as it is.
  void solid_box(const world::WorldBox& shape, int material);

 private:
  Scene& scene_;
  Layer layer_ = Layer::kFixed;
  int gate_ = -1;
  bool bars_ = false, closed_ = false;
};

/// One of a room's four walls: a runs along it, b into the room.
struct RoomWall {
  FloorFrame frame;
  double length = 0.0;  ///< [m]
};
/// @param side  0..3, around the room.
[[nodiscard]] RoomWall wall_of(const world::World& world, int side);

/// Draws the looks. The builder's layer is kFixed.
void dress_showroom(SceneBuilder& builder, const world::World& world);
void dress_hall(SceneBuilder& builder, const world::World& world);
void dress_dark_hall(SceneBuilder& builder, const world::World& world);
void dress_exhibition(SceneBuilder& builder, const world::World& world);

}  // namespace gatefly::sim
