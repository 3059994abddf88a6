#include "harness/plan/motion.h"

#include "algorithms/error.h"
#include "algorithms/kernel/direction.h"
#include "process/whole_file.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

namespace hausbench {

namespace {

double fraction(int step, int steps) { return steps == 1 ? 0.0 : double(step) / double(steps - 1); }

std::vector<Pose> translated(const Translation& motion, const Shape& shape) {
    const double unit = motion.of == Translation::Of::diagonal  ? diagonal(points_of(shape))
                        : motion.of == Translation::Of::longest ? longest_side(points_of(shape))
                                                                : 1.0;
    std::vector<Pose> poses(static_cast<std::size_t>(motion.steps));
    for (int i = 0; i < motion.steps; ++i) {
        const double s = fraction(i, motion.steps);
        poses[std::size_t(i)].translation = unit * ((1 - s) * motion.from + s * motion.to);
    }
    return poses;
}

// Returns whether a rotation by this angle ends where it begins, so that its last pose would repeat the first.
bool full_turns(double degrees) { return degrees != 0 && std::fmod(degrees, 360.0) == 0; }

std::vector<Pose> rotated(const Rotation& motion, const Shape& shape) {
    const Points& points = points_of(shape);
    const Vec3 centre = 0.5 * (points.colwise().minCoeff() + points.colwise().maxCoeff()).transpose();
    std::vector<Pose> poses(static_cast<std::size_t>(motion.steps));
    const int steps = full_turns(motion.degrees) ? motion.steps + 1 : motion.steps;  // the last step is not made
    for (int i = 0; i < motion.steps; ++i) {
        const double angle = motion.degrees * fraction(i, steps) * std::numbers::pi / 180;
        if (angle == 0) continue;  // the pose stays exactly the identity
        Pose& pose = poses[std::size_t(i)];
        pose.rotation = Eigen::AngleAxisd(angle, at_unit_scale(motion.axis).normalized()).toRotationMatrix();
        pose.translation = centre - pose.rotation * centre;
    }
    return poses;
}

std::vector<Pose> read_poses(const std::filesystem::path& file) {
    expect_no_device(file);
    std::ifstream in(file);
    if (!in)
        throw InputError(
            fmt::format("{}: cannot open the pose file: check its path (relative to the experiment)", file.string()));
    std::vector<Pose> poses;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (const auto comment = line.find('#'); comment != std::string::npos) line.resize(comment);
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        std::istringstream words(line);
        const auto numbers = finite_numbers(words, 12);
        if (!numbers) {
            throw InputError(fmt::format(
                "{}:{}: a pose is twelve finite numbers (rotation row by row, then translation): correct this line",
                file.string(), number));
        }
        const std::vector<double>& values = *numbers;
        Pose pose;
        for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = values[std::size_t(i)];
        for (int i = 0; i < 3; ++i) pose.translation[i] = values[std::size_t(9 + i)];
        poses.push_back(pose);
    }
    if (poses.empty())
        throw InputError(
            fmt::format("{}: contains no poses: write at least one line of twelve numbers", file.string()));
    return poses;
}

}  // namespace

std::vector<Pose> poses_of(const Motion& motion, const Shape& shape) {
    if (const auto* m = std::get_if<Translation>(&motion)) return translated(*m, shape);
    if (const auto* m = std::get_if<Rotation>(&motion)) return rotated(*m, shape);
    if (const auto* m = std::get_if<PoseFile>(&motion)) return read_poses(m->file);
    if (const auto* m = std::get_if<Recorded>(&motion)) return m->poses;
    return {Pose{}};
}

std::size_t pose_count(const Motion& motion) {
    if (const auto* m = std::get_if<Translation>(&motion)) return std::size_t(m->steps);
    if (const auto* m = std::get_if<Rotation>(&motion)) return std::size_t(m->steps);
    if (const auto* m = std::get_if<PoseFile>(&motion)) return read_poses(m->file).size();
    if (const auto* m = std::get_if<Recorded>(&motion)) return m->poses.size();
    return 1;
}

std::optional<std::vector<double>> finite_numbers(std::istream& line, std::size_t count) {
    std::vector<double> numbers;
    for (std::string word; line >> word;) {
        char* end = nullptr;
        numbers.push_back(std::strtod(word.c_str(), &end));
        if (end != word.c_str() + word.size() || !std::isfinite(numbers.back())) return std::nullopt;
    }
    return numbers.size() == count ? std::optional(numbers) : std::nullopt;
}

bool moves(const Motion& motion) { return !std::holds_alternative<Static>(motion); }

}  // namespace hausbench
