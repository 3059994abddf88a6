// The motion of a scene's source or target, as a list of poses.
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

// `steps` poses from `from` to `to`, both included. Lengths are in units of the diagonal or longest side of the
// moving shape's box, or absolute.
struct Translation {
    enum class Of { diagonal, longest, absolute };
    Vec3 from, to;
    int steps;
    Of of;
};

// `steps` poses from 0 to `degrees` about an axis through the centre of the box of the shape as loaded. Both ends are
// included, unless `degrees` is a multiple of 360: the last pose would repeat the first and is left out.
struct Rotation {
    Vec3 axis;
    double degrees;
    int steps;
};

// A text file with twelve numbers per line: the rotation row by row, then the translation; '#' begins a comment.
struct PoseFile {
    std::filesystem::path file;
};

// The poses of one of the two objects that overlap in a recording (recording.h).
struct Recorded {
    std::vector<Pose> poses;
};

using Motion = std::variant<Static, Translation, Rotation, PoseFile, Recorded>;

// Returns the poses of a motion of this shape. For a pose file, throws InputError if it cannot be opened or has no
// poses, or with the number of a line that does not hold twelve finite numbers.
std::vector<Pose> poses_of(const Motion& motion, const Shape& shape);

// Returns the number of poses. Reads a pose file, and throws InputError as above.
std::size_t pose_count(const Motion& motion);

bool moves(const Motion& motion);

// Returns the words of a line as numbers; nothing unless they are exactly `count` finite numbers.
std::optional<std::vector<double>> finite_numbers(std::istream& line, std::size_t count);

}  // namespace hausbench
