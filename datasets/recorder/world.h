// Rigid bodies that fall and touch each other, simulated with Bullet.
#pragma once

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <Eigen/Geometry>

#include <memory>
#include <string>
#include <vector>

namespace recorder {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

struct Pose {
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

// A closed mesh, and its copy for Bullet. Bullet needs coordinates whose origin is the centre of mass and whose axes
// are the principal axes of inertia; `frame` converts them to the coordinates of the mesh.
struct Model {
    std::string name;
    Mesh mesh;
    double volume = 0;
    Pose frame;               // a point q of Bullet's copy is the point turn * q + shift of the mesh
    Eigen::Vector3d inertia;  // about the principal axes, for density 1
    // Bullet's copy of the mesh. `shape` has pointers into these vectors.
    std::vector<double> coordinates;
    std::vector<int> corners;
    std::unique_ptr<btTriangleIndexVertexArray> triangles;
    std::unique_ptr<btGImpactMeshShape> shape;
};

inline Eigen::Vector3d to_eigen(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

// Reads FOLDER/NAME.off. Throws std::runtime_error if it is not a closed mesh.
std::unique_ptr<Model> read_model(const std::string& folder, const std::string& name);

// Lengths are in units of the models.
struct Settings {
    double step = 1.0 / 240;  // seconds; Bullet's default for fast bodies
    int iterations = 10;      // of Bullet's solver; its default
    double gravity = 9.81;
    double density = 20;  // so that a bunny or a letter has a mass of about 1
    // Spring and damper at each point of contact between a body and the ground. Between two bodies the springs
    // are in series, with half the stiffness; Bullet adds up the damping. Stiffness 0 means rigid contacts.
    double stiffness = 0, damping = 0;
    double friction = 0;
    double drag = 0;  // share of its velocity that a body loses per second
    // A frame is a state of the simulation that is recorded.
    int steps_per_frame = 0, frames = 0;

    bool rigid() const { return stiffness == 0; }
};

struct Body {
    const Model* model;
    Pose pose;  // initial pose of the mesh
    Eigen::Vector3d velocity;
    bool asleep;  // does not move until another body touches it
};

// A simulation of bodies over the ground z = 0.
class World {
public:
    explicit World(const Settings& settings);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    void add(const Body& body);

    // Simulates the steps from one frame to the next.
    void advance();

    std::size_t size() const { return models_.size(); }
    const Model& model(std::size_t body) const { return *models_[body]; }
    Pose pose(std::size_t body) const;

private:
    Settings settings_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    btStaticPlaneShape ground_{btVector3(0, 0, 1), 0};
    std::vector<std::unique_ptr<btRigidBody>> bodies_;  // bodies_[0] is the ground
    std::vector<const Model*> models_;
};

}  // namespace recorder
