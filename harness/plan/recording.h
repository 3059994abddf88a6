// A recorded simulation: the moving objects that overlap in each frame, and their poses. docs/experiments.md
// describes the format.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Recording {
    // Everything recorded about two models: the frames in which an object with the first model overlaps an object with
    // the second, in order, and the poses of the two objects there. A frame may occur several times, because several
    // objects may have the same model.
    struct Pair {
        std::string source, target;
        std::vector<int> frames;
        std::vector<Pose> source_poses, target_poses;  // one of each for each entry of `frames`
    };

    int frames = 0;  // number of recorded frames, with or without a pair
    std::vector<Pair> pairs;
};

// Reads a recording. Quaternions are normalised; a rotation is accurate to a few units in the last place. Throws
// InputError with the line that is wrong.
Recording read_recording(const std::filesystem::path& file);

}  // namespace hausbench
