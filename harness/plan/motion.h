// How the source or the target of a scene moves, and its pose at each step.
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

// `steps` evenly spaced translations from `from` to `to`, both included. Lengths are absolute, or multiples of the
// diagonal or the longest side of the shape's bounding box.
struct Translation {
    enum class Of { diagonal, longest, absolute };
    Vec3 from, to;
    int steps;
    Of of;
};

// `steps` evenly spaced rotations from 0 to `degrees`, both included, about an axis through the centre of the bounding
// box. If `degrees` is a multiple of 360, the last rotation is left out, because it would repeat the first.
struct Rotation {
    Vec3 axis;
    double degrees;
    int steps;
};

// A text file with twelve numbers per line: the rotation row by row, then the translation; '#' begins a comment.
struct PoseFile {
    std::filesystem::path file;
};

// The poses of one object of an overlapping pair in a recorded simulation (recording.h).
struct Recorded {
    std::vector<Pose> poses;
};

using Motion = std::variant<Static, Translation, Rotation, PoseFile, Recorded>;

// Returns the poses of a motion of this shape. Throws InputError if a pose file cannot be opened, has no poses, or has
// a line that is not twelve finite numbers.
std::vector<Pose> poses_of(const Motion& motion, const Shape& shape);

// Returns the number of poses. For a pose file, reads the file and throws the same errors as poses_of().
std::size_t pose_count(const Motion& motion);

bool moves(const Motion& motion);

// Reads a line of exactly `count` finite numbers. Returns nothing if the line has anything else.
std::optional<std::vector<double>> finite_numbers(std::istream& line, std::size_t count);

}  // namespace hausbench
