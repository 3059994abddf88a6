// A recorded simulation: the moving objects that overlap in each frame, and their poses. docs/experiments.md
// describes the format.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Recording {
    // All overlapping pairs of objects with these models, in the order of the frames.
    struct Pair {
        std::string source, target;
        std::vector<int> frames;
        std::vector<Pose> source_poses, target_poses;
    };

    int frames = 0;  // number of recorded frames, with or without a pair
    std::vector<Pair> pairs;
};

// Reads a recording. Throws InputError with the line that is wrong. Quaternions are normalised; a rotation is
// accurate to a few units in the last place.
Recording read_recording(const std::filesystem::path& file);

}  // namespace hausbench
