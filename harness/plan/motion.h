// Motions: the poses of a scene's source, or of its target.
#pragma once

#include "algorithms/scene.h"

#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {

struct Static {};

// `steps` poses from `from` to `to`, both included; in the diagonal or the longest side of the box of the shape that moves, or absolute.
struct Translation {
    enum class Of { diagonal, longest, absolute };
    Vec3 from, to;
    int steps;
    Of of;
};

// `steps` poses from 0 to `degrees` about an axis through the centre of the box of the shape as loaded; both ends are included, but for a
// multiple of 360 degrees, where the end is the beginning and is left out.
struct Rotation {
    Vec3 axis;
    double degrees;
    int steps;
};

// A text file with twelve numbers in each line: the rotation row by row, then the translation; '#' begins a comment.
struct PoseFile {
    std::filesystem::path file;
};

// Those of one side of a pair of objects of a recording (recording.h).
struct Recorded {
    std::vector<Pose> poses;
};

using Motion = std::variant<Static, Translation, Rotation, PoseFile, Recorded>;

// Throws InputError with the line of a pose file that does not hold twelve finite numbers.
std::vector<Pose> poses_of(const Motion& motion, const Shape& shape);

// How many they are; throws likewise.
std::size_t pose_count(const Motion& motion);

bool moves(const Motion& motion);

// The words of a line, if they are so many finite numbers and nothing else.
std::optional<std::vector<double>> finite_numbers(std::istream& line, std::size_t count);

}  // namespace hausbench
