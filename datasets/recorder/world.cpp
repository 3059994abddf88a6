#include "world.h"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <CGAL/Surface_mesh/IO/OFF.h>
#include <CGAL/boost/graph/helpers.h>
#include <Eigen/Eigenvalues>

#include <stdexcept>

namespace recorder {

using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector3d;

namespace {

// Computes volume, frame and inertia: sums of signed integrals over the tetrahedra that the origin forms with each
// triangle.
void weigh(Model& model) {
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    for (const auto face : model.mesh.faces()) {
        Matrix3d corners;
        int column = 0;
        for (const auto vertex : model.mesh.vertices_around_face(model.mesh.halfedge(face)))
            corners.col(column++) = to_eigen(model.mesh.point(vertex));
        const double six_volumes = corners.determinant();
        const Vector3d sum = corners.rowwise().sum();
        model.volume += six_volumes / 6;
        first += six_volumes / 24 * sum;
        second += six_volumes / 120 * (corners * corners.transpose() + sum * sum.transpose());
    }
    const Vector3d centre = first / model.volume;
    const Matrix3d spread = second - model.volume * centre * centre.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(spread.trace() * Matrix3d::Identity() - spread);
    Matrix3d axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) *= -1;
    model.frame = {Quaterniond(axes), centre};
    model.inertia = solver.eigenvalues();
}

btVector3 to_bullet(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::unique_ptr<Model> read_model(const std::string& folder, const std::string& name) {
    auto model = std::make_unique<Model>();
    model->name = name;
    if (!CGAL::IO::read_OFF(folder + "/" + name + ".off", model->mesh) || !CGAL::is_closed(model->mesh))
        throw std::runtime_error(folder + "/" + name + ".off: no closed mesh can be read from it");
    weigh(*model);
    for (const auto vertex : model->mesh.vertices()) {
        const Vector3d moved =
            model->frame.turn.conjugate() * (to_eigen(model->mesh.point(vertex)) - model->frame.shift);
        model->coordinates.insert(model->coordinates.end(), moved.begin(), moved.end());
    }
    for (const auto face : model->mesh.faces())
        for (const auto vertex : model->mesh.vertices_around_face(model->mesh.halfedge(face)))
            model->corners.push_back(static_cast<int>(vertex.idx()));
    model->triangles = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(model->corners.size() / 3), model->corners.data(), int{3 * sizeof(int)},
        static_cast<int>(model->coordinates.size() / 3), model->coordinates.data(), int{3 * sizeof(double)});
    model->shape = std::make_unique<btGImpactMeshShape>(model->triangles.get());
    model->shape->setMargin(0);  // bodies touch only where their triangles touch
    model->shape->updateBound();
    return model;
}

World::World(const Settings& settings) : settings_(settings) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    world_.setGravity(btVector3(0, 0, -settings.gravity));
    world_.getSolverInfo().m_splitImpulse = settings.rigid();  // off if soft: it pushes bodies apart at any stiffness
    world_.getSolverInfo().m_numIterations = settings.iterations;
    bodies_.push_back(std::make_unique<btRigidBody>(0, nullptr, &ground_));
    bodies_.back()->setFriction(settings.friction);
    world_.addRigidBody(bodies_.back().get());
}

World::~World() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
}

void World::add(const Body& body) {
    const Model& model = *body.model;
    const Quaterniond turn = body.pose.turn * model.frame.turn;
    const Vector3d place = body.pose.turn * model.frame.shift + body.pose.shift;
    auto rigid = std::make_unique<btRigidBody>(settings_.density * model.volume, nullptr, model.shape.get(),
                                               to_bullet(settings_.density * model.inertia));
    rigid->setWorldTransform(btTransform(btQuaternion(turn.x(), turn.y(), turn.z(), turn.w()), to_bullet(place)));
    rigid->setLinearVelocity(to_bullet(body.velocity));
    if (!settings_.rigid()) rigid->setContactStiffnessAndDamping(settings_.stiffness, settings_.damping);
    rigid->setFriction(settings_.friction);
    rigid->setDamping(settings_.drag, settings_.drag);
    rigid->setActivationState(body.asleep ? ISLAND_SLEEPING : DISABLE_DEACTIVATION);
    world_.addRigidBody(rigid.get());
    bodies_.push_back(std::move(rigid));
    models_.push_back(&model);
}

void World::advance() {
    for (int i = 0; i < settings_.steps_per_frame; ++i) world_.stepSimulation(settings_.step, 0);
}

Pose World::pose(std::size_t body) const {
    const btTransform& now = bodies_[body + 1]->getWorldTransform();
    const btQuaternion q = now.getRotation();
    const btVector3& place = now.getOrigin();
    const Pose& frame = models_[body]->frame;
    const Quaterniond turn = (Quaterniond(q.w(), q.x(), q.y(), q.z()) * frame.turn.conjugate()).normalized();
    return {turn, Vector3d(place.x(), place.y(), place.z()) - turn * frame.shift};
}

}  // namespace recorder
