#include "simulation/pile.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace binpick::simulation {
namespace {

// Bullet's tolerances suit bodies of about one unit, so a unit is a tenth of a metre.
constexpr double kMmPerUnit = 100;
constexpr double kGravity = 98.1;
// At half this rate parts sink into each other.
constexpr double kStepSeconds = 1.0 / 240;
// Parts are slowed to this, in units per second: no more than 1.7 mm in a step, so that thin sheet
// does not pass through sheet.
constexpr double kSpeedMax = 4;
// A part that has moved less than this for a while sleeps. Gravity takes a part without support
// beyond it within a step.
constexpr double kRestSpeed = 0.1;  // units per second
constexpr double kRestTurn = 0.5;   // radians per second
constexpr double kRestSeconds = 0.15;
// Between two layers of parts; the time that they may take to come to rest before the chute goes,
// and after.
constexpr double kLayerSeconds = 0.15;
constexpr double kLandingSeconds = 1.5;
constexpr double kSettlingSeconds = 2.5;
constexpr double kDropMm = 2;  // from the lowest point of a layer to the highest of the pile
constexpr double kMarginMm = 0.15;

btVector3 to_bullet(const Vec3& p_mm) {
  const Vec3 p = p_mm / kMmPerUnit;
  return {static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()), static_cast<btScalar>(p.z())};
}

Vec3 from_bullet(const btVector3& p) {
  return Vec3(p.x(), p.y(), p.z()) * kMmPerUnit;
}

// A uniformly random rotation, from a random point on the sphere of quaternions.
btQuaternion random_rotation(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  const double z = rng.normal();
  const double w = rng.normal();
  btQuaternion q(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z),
                 static_cast<btScalar>(w));
  return q.normalized();
}

// A part's collision shape about its centre of mass, as Bullet wants it.
struct BodyShape {
  std::vector<std::unique_ptr<btConvexHullShape>> hulls;
  std::unique_ptr<btCompoundShape> compound;
  Vec3 centre_mm = Vec3::Zero();
  btVector3 inertia{0, 0, 0};
  btScalar mass = 1;
};

BodyShape make_body_shape(const CollisionShape& shape) {
  BodyShape body;
  double volume = 0;
  for (const auto& piece : shape.pieces) {
    Vec3 mean = Vec3::Zero();
    for (const auto& p : piece) mean += p;
    mean /= static_cast<double>(piece.size());
    const double piece_volume = hull_volume(piece);
    volume += piece_volume;
    body.centre_mm += piece_volume * mean;
  }
  body.centre_mm /= std::max(volume, 1e-9);
  body.compound = std::make_unique<btCompoundShape>();
  for (const auto& piece : shape.pieces) {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const auto& p : piece) hull->addPoint(to_bullet(p - body.centre_mm), false);
    hull->recalcLocalAabb();
    hull->setMargin(static_cast<btScalar>(kMarginMm / kMmPerUnit));
    body.compound->addChildShape(btTransform::getIdentity(), hull.get());
    body.hulls.push_back(std::move(hull));
  }
  body.mass = static_cast<btScalar>(std::clamp(volume / 5000, 0.3, 10.0));
  body.compound->calculateLocalInertia(body.mass, body.inertia);
  return body;
}

// Bullet has one time of rest for all worlds, so it is set once for all threads.
void set_rest_time() {
  static const btScalar set = gDeactivationTime = static_cast<btScalar>(kRestSeconds);
  static_cast<void>(set);
}

class World {
 public:
  World()
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    set_rest_time();
    world_.setGravity({0, 0, static_cast<btScalar>(-kGravity)});
    btContactSolverInfo& info = world_.getSolverInfo();
    info.m_numIterations = 30;
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = static_cast<btScalar>(-0.002);
    info.m_erp2 = static_cast<btScalar>(0.4);
  }
  ~World() {
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // A fixed box between two corners.
  btRigidBody* add_box(const Vec3& min_mm, const Vec3& max_mm) {
    boxes_.push_back(std::make_unique<btBoxShape>(to_bullet((max_mm - min_mm) / 2)));
    btTransform at = btTransform::getIdentity();
    at.setOrigin(to_bullet((min_mm + max_mm) / 2));
    return add_body(0, boxes_.back().get(), {0, 0, 0}, at);
  }

  btRigidBody* add_part(const BodyShape& shape, const btTransform& at) {
    btRigidBody* body = add_body(shape.mass, shape.compound.get(), shape.inertia, at);
    body->setDamping(static_cast<btScalar>(0.1), static_cast<btScalar>(0.25));
    body->setSleepingThresholds(static_cast<btScalar>(kRestSpeed),
                                static_cast<btScalar>(kRestTurn));
    return body;
  }

  // Wakes all parts: what leaned on the body has to notice.
  void remove(btRigidBody* body) {
    world_.removeRigidBody(body);
    std::erase_if(bodies_, [body](const auto& b) { return b.get() == body; });
    for (auto& other : bodies_) other->activate(true);
  }

  // Until all parts sleep, but no longer than so many seconds.
  void run(double seconds) {
    for (double t = 0; t < seconds && !asleep(); t += kStepSeconds) {
      world_.stepSimulation(static_cast<btScalar>(kStepSeconds), 0);
      for (auto& body : bodies_) {
        const btScalar speed = body->getLinearVelocity().length();
        if (speed > static_cast<btScalar>(kSpeedMax)) {
          body->setLinearVelocity(body->getLinearVelocity() *
                                  (static_cast<btScalar>(kSpeedMax) / speed));
        }
      }
    }
  }

 private:
  btRigidBody* add_body(btScalar mass, btCollisionShape* shape, const btVector3& inertia,
                        const btTransform& at) {
    states_.push_back(std::make_unique<btDefaultMotionState>(at));
    btRigidBody::btRigidBodyConstructionInfo info(mass, states_.back().get(), shape, inertia);
    info.m_friction = static_cast<btScalar>(0.4);
    info.m_rollingFriction = static_cast<btScalar>(0.001);
    info.m_restitution = 0;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  bool asleep() const {
    return std::none_of(bodies_.begin(), bodies_.end(), [](const auto& body) {
      return !body->isStaticObject() && body->isActive();
    });
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btBoxShape>> boxes_;
  std::vector<std::unique_ptr<btDefaultMotionState>> states_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

// Floor and walls; returns the chute above the walls, which goes away when all parts have fallen.
std::vector<btRigidBody*> add_bin(World& world, const BinSize& bin) {
  constexpr double kDeep = 40;
  constexpr double kChute = 2000;
  const double x = bin.length / 2;
  const double y = bin.width / 2;
  world.add_box({-400, -400, -kDeep}, {400, 400, 0});
  std::vector<btRigidBody*> chute;
  for (double side : {-1.0, 1.0}) {
    const auto wall = [&](const Vec3& a, const Vec3& b, double z0, double z1) {
      Vec3 min = a.cwiseMin(b);
      Vec3 max = a.cwiseMax(b);
      min.z() = z0;
      max.z() = z1;
      return world.add_box(min, max);
    };
    const Vec3 x0(side * x, -y - kDeep, 0);
    const Vec3 y0(-x - kDeep, side * y, 0);
    wall(x0, Vec3(side * (x + bin.wall), y + kDeep, 0), -kDeep, bin.height);
    wall(y0, Vec3(x + kDeep, side * (y + bin.wall), 0), -kDeep, bin.height);
    chute.push_back(wall(x0, Vec3(side * (x + kDeep), y + kDeep, 0), bin.height, kChute));
    chute.push_back(wall(y0, Vec3(x + kDeep, side * (y + kDeep), 0), bin.height, kChute));
  }
  return chute;
}

// The bin cut into cells in which parts may have any rotation without touching each other. A layer
// has a part in each.
struct Cells {
  BinSize bin;
  double radius_mm;  // of the largest part
  int columns = cells_along(bin.length), rows = cells_along(bin.width);

  int count() const { return columns * rows; }

  // Somewhere in the cell, and no lower than z_mm.
  btTransform place(int cell, const BodyShape& shape, double z_mm, Rng& rng) const {
    btTransform at(random_rotation(rng));
    btVector3 low, high;
    shape.compound->getAabb(at, low, high);
    const double x = along(cell % columns, columns, bin.length, rng);
    const double y = along(cell / columns, rows, bin.width, rng);
    at.setOrigin(to_bullet(Vec3(x, y, z_mm - from_bullet(low).z())));
    return at;
  }

 private:
  int cells_along(double size_mm) const {
    return std::max(1, static_cast<int>(size_mm / (2 * radius_mm)));
  }
  double along(int index, int cells, double size_mm, Rng& rng) const {
    const double cell_mm = size_mm / cells;
    const double free_mm = std::max(0.0, cell_mm / 2 - radius_mm);
    return (index + 0.5) * cell_mm - size_mm / 2 + rng.uniform(-free_mm, free_mm);
  }
};

double top_of(const std::vector<btRigidBody*>& parts) {
  double top_mm = 0;
  for (const btRigidBody* part : parts) {
    btVector3 low, high;
    part->getAabb(low, high);
    top_mm = std::max(top_mm, from_bullet(high).z());
  }
  return top_mm;
}

// Lets all parts fall, layer by layer.
std::vector<btRigidBody*> drop_parts(World& world, const std::vector<BodyShape>& shapes,
                                     const std::vector<std::size_t>& kinds, const Cells& cells,
                                     Rng& rng) {
  std::vector<btRigidBody*> parts;
  while (parts.size() < kinds.size()) {
    const double z_mm = top_of(parts) + kDropMm;
    for (int cell = 0; cell < cells.count() && parts.size() < kinds.size(); ++cell) {
      const BodyShape& shape = shapes[kinds[parts.size()]];
      parts.push_back(world.add_part(shape, cells.place(cell, shape, z_mm, rng)));
    }
    world.run(kLayerSeconds);
  }
  return parts;
}

}  // namespace

std::vector<PlacedPart> make_pile(const std::vector<CollisionShape>& shapes,
                                  const std::vector<std::size_t>& kinds, const BinSize& bin,
                                  Rng rng) {
  std::vector<BodyShape> body_shapes;
  for (const auto& shape : shapes) body_shapes.push_back(make_body_shape(shape));
  double radius_mm = 1;
  for (std::size_t kind : kinds) radius_mm = std::max(radius_mm, shapes[kind].radius_mm);
  World world;
  const std::vector<btRigidBody*> chute = add_bin(world, bin);
  const std::vector<btRigidBody*> parts =
      drop_parts(world, body_shapes, kinds, Cells{bin, radius_mm}, rng);
  world.run(kLandingSeconds);
  for (btRigidBody* wall : chute) world.remove(wall);
  world.run(kSettlingSeconds);

  std::vector<PlacedPart> placed;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const btTransform& at = parts[i]->getWorldTransform();
    const Vec3 centre = from_bullet(at.getOrigin());
    const btQuaternion turn = at.getRotation();
    PlacedPart part;
    part.kind = kinds[i];
    part.T_world_obj.R =
        Eigen::Quaterniond(turn.w(), turn.x(), turn.y(), turn.z()).toRotationMatrix();
    part.T_world_obj.t_mm = centre - part.T_world_obj.R * body_shapes[part.kind].centre_mm;
    const bool inside = std::abs(centre.x()) < bin.length / 2 &&
                        std::abs(centre.y()) < bin.width / 2 && centre.z() > 0;
    if (inside) placed.push_back(part);
  }
  return placed;
}

}  // namespace binpick::simulation
