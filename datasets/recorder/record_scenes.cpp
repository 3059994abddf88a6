// Simulates the two dynamic scenes of Tang et al. 2009, and records the poses of the bodies that overlap.
//
//     record_scenes domino|bunnies|domino_soft|bunnies_soft MODELS FILE
//
// MODELS is a folder with a file NAME.off for each model, written by `hausbench export`. Bodies are rigid and of
// uniform density, and Bullet gets the triangles of their meshes, not convex hulls. Contacts are rigid, as they are by
// default in Bullet and in the engine of the paper (Havok): bodies overlap by about a thousandth of their size. In the
// soft scenes, contacts are springs with dampers, and bodies overlap by a few per cent, as in the penalty-based
// simulations that need the penetration depth. All steps have the same length. Bullet uses one thread here and no
// clock, so all runs on one machine write the same file.
#include "datasets/random.h"
#include "world.h"

#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

namespace recorder {
namespace {

using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector3d;
namespace pmp = CGAL::Polygon_mesh_processing;

// A body as recorded: the text of the seven numbers of its pose, rounded to nine digits, and its mesh moved by exactly
// the pose that this text gives.
struct Posed {
    std::string text;
    Mesh mesh;
    CGAL::Bbox_3 box;
};

Posed posed(const Model& model, const Pose& pose) {
    Posed result;
    std::array<double, 7> numbers{pose.turn.w(),  pose.turn.x(),  pose.turn.y(), pose.turn.z(),
                                  pose.shift.x(), pose.shift.y(), pose.shift.z()};
    for (double& number : numbers) {
        const std::string digits = fmt::format("{:.9g}", number);
        number = std::stod(digits);
        result.text += " " + digits;
    }
    const Matrix3d turn = Quaterniond(numbers[0], numbers[1], numbers[2], numbers[3]).normalized().toRotationMatrix();
    const Vector3d shift(numbers[4], numbers[5], numbers[6]);
    result.mesh = model.mesh;
    for (const auto vertex : result.mesh.vertices()) {
        const Vector3d p = turn * to_eigen(model.mesh.point(vertex)) + shift;
        result.mesh.point(vertex) = Kernel::Point_3(p.x(), p.y(), p.z());
    }
    result.box = pmp::bbox(result.mesh);
    return result;
}

// Returns the lines for one frame, one for each pair of bodies that overlap.
std::string pairs(const World& world, int frame) {
    std::vector<Posed> all;
    for (std::size_t i = 0; i < world.size(); ++i) all.push_back(posed(world.model(i), world.pose(i)));
    std::string lines;
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size(); ++j) {
            if (!CGAL::do_overlap(all[i].box, all[j].box) || !pmp::do_intersect(all[i].mesh, all[j].mesh)) continue;
            lines += fmt::format("pair {} {} {}{}{}\n", frame, i, j, all[i].text, all[j].text);
        }
    }
    return lines;
}

class Models {
public:
    explicit Models(std::string folder) : folder_(std::move(folder)) {}

    const Model& operator[](const std::string& name) {
        auto& model = read_[name];
        if (!model) model = read_model(folder_, name);
        return *model;
    }

private:
    std::string folder_;
    std::map<std::string, std::unique_ptr<Model>> read_;
};

// Returns the least z coordinate of the turned model.
double lowest(const Model& model, const Quaterniond& turn) {
    double z = std::numeric_limits<double>::infinity();
    for (const auto vertex : model.mesh.vertices()) z = std::min(z, (turn * to_eigen(model.mesh.point(vertex))).z());
    return z;
}

struct Plan {
    std::string title;
    Settings settings;
    std::vector<Body> bodies;
};

void soften(Settings& settings, double stiffness, double damping) {
    settings.stiffness = stiffness;
    settings.damping = damping;
    settings.step = 1e-3;  // seconds; short, because the springs are stiff
    settings.iterations = 50;
}

// Builds the domino scene. The letters sleep until they are touched, because C, F and S do not stand by themselves.
Plan domino(Models& models, bool soft) {
    Plan plan{"Alphabet Domino: twelve letters fall one onto the other; a bunny hits the first.", {}, {}};
    plan.settings.friction = 0.6;
    if (soft) soften(plan.settings, 400, 20);
    plan.settings.steps_per_frame = soft ? 20 : 4;
    plan.settings.frames = 240;
    const Quaterniond upright(0.5, 0.5, 0.5, 0.5);  // a letter's depth runs along x, its height along z
    for (const char letter : std::string("hausdorfbenc")) {
        const Model& model = models[std::string("letter_") + letter];
        const Vector3d place(0.5 * static_cast<double>(plan.bodies.size()), -(upright * model.frame.shift).y(),
                             -lowest(model, upright));
        plan.bodies.push_back({&model, {upright, place}, Vector3d::Zero(), true});
    }
    const Quaterniond sitting(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()));
    plan.bodies.push_back({&models["bunny_1k"], {sitting, {-0.9, 0, 0.6}}, {soft ? 4.0 : 8.0, 0, 0.5}, false});
    return plan;
}

// Builds the scene of the falling bunnies: layers of up to seven, each bunny turned at random and moved a little.
Plan bunnies(Models& models, bool soft) {
    Plan plan{"Falling Bunnies: fifty bunnies fall into a heap.", {}, {}};
    plan.settings.friction = 0.8;
    if (soft) {
        soften(plan.settings, 800, 60);
        plan.settings.drag = 0.7;  // without it, the last bunnies are too fast for such soft springs
    }
    plan.settings.steps_per_frame = soft ? 100 : 24;
    plan.settings.frames = soft ? 30 : 40;
    const Model& bunny = models["bunny_1k"];
    const hausbench::RandomNumbers random(2009);
    for (std::uint64_t i = 0; i < 50; ++i) {
        const auto number = [&](std::uint64_t k) { return 2 * random.uniform(8 * i + k) - 1; };
        const double layer = static_cast<double>(i / 7), place = static_cast<double>(i % 7);
        const double angle = std::numbers::pi / 3 * place + layer, radius = place == 0 ? 0 : 0.9;
        const Vector3d centre(radius * std::cos(angle) + 0.04 * number(0), radius * std::sin(angle) + 0.04 * number(1),
                              0.6 + 0.85 * layer + 0.04 * number(2));
        const Quaterniond turn = Quaterniond(number(3), number(4), number(5), number(6)).normalized();
        plan.bodies.push_back({&bunny, {turn, centre - turn * bunny.frame.shift}, Vector3d::Zero(), false});
    }
    return plan;
}

std::string head(const Plan& plan) {
    const Settings& s = plan.settings;
    std::string text = fmt::format("# {}\n", plan.title);
    text +=
        "# It stands in for the scene of this name of Tang et al. 2009, whose models and motion are not published.\n";
    text +=
        "# Written by `tools/recordings` (datasets/recorder). Lengths are in units of the models, times in seconds.\n";
    text += fmt::format(
        "# Simulated with Bullet {}.{} in double precision: triangle meshes of density {} over the ground z = 0,\n",
        btGetVersion() / 100, btGetVersion() % 100, s.density);
    const std::string contacts =
        s.rigid() ? "rigid contacts"
                  : fmt::format("stiffness {} and damping {} of a point of contact", s.stiffness, s.damping);
    text += fmt::format("# step {:.6g}, {} iterations, gravity {}, {}, friction {}, drag {}.\n", s.step, s.iterations,
                        s.gravity, contacts, s.friction, s.drag);
    text += fmt::format(
        "# Frame i is the state after {} (i + 1) steps; the first {} such states are kept. A pair is written if its\n",
        s.steps_per_frame, s.frames);
    text += "# triangles intersect in the poses as written. No pair with the ground is.\n";
    text += fmt::format("hausbench recording 1\nframes {}\n", s.frames);
    return text;
}

void record(const std::string& scene, const std::string& folder, const std::string& file) {
    const bool soft = scene.ends_with("_soft");
    const std::string kind = soft ? scene.substr(0, scene.size() - 5) : scene;
    if (kind != "domino" && kind != "bunnies")
        throw std::runtime_error("there is no scene " + scene + ": domino or bunnies, and _soft after it or not");
    Models models(folder);
    const Plan plan = kind == "domino" ? domino(models, soft) : bunnies(models, soft);
    World world(plan.settings);
    std::string text = head(plan);
    for (const Body& body : plan.bodies) {
        text += fmt::format("object {} {}\n", world.size(), body.model->name);
        world.add(body);
    }
    for (int frame = 0; frame < plan.settings.frames; ++frame) {
        world.advance();
        text += pairs(world, frame);
    }
    std::ofstream out(file);
    out << text;
    if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace
}  // namespace recorder

int main(int count, char** arguments) {
    try {
        if (count != 4)
            throw std::runtime_error("usage: record_scenes domino|bunnies|domino_soft|bunnies_soft MODELS FILE");
        recorder::record(arguments[1], arguments[2], arguments[3]);
    } catch (const std::exception& error) {
        std::cerr << "record_scenes: " << error.what() << "\n";
        return 1;
    }
}
