// The worker process: loads a scene, prepares a solver, answers and times its cases, and tells the runner through a pipe.
#pragma once

#include "plan.h"
#include "session.h"

#include <nlohmann/json.hpp>

namespace hausbench {

// What a worker is told on its standard input, as one JSON object.
struct WorkOrder {
    std::string solver;
    ParameterMap options;
    std::filesystem::path source_file, target_file;
    QuerySet queries;
    Limits limits;
    int round = 0, repeats = 0;
    Leave leave = Leave::out_what_is_not_needed;
    struct Item {
        std::size_t row;
        Pose pose;
        Tolerance tolerance;
        double floor, cutoff;
        std::int64_t budget;  // -1: none
        bool trace;
        std::vector<double> marks;
    };
    std::vector<Item> items;
    std::map<std::filesystem::path, std::string> plugins = {};  // file -> SHA-256
};

nlohmann::json to_json(const WorkOrder& order);
WorkOrder work_order_from_json(const nlohmann::json& json);

// The hidden verb `worker`: one JSON object a line on file descriptor `events`, see worker.cpp. Returns the exit code.
int worker_main(int events);

}  // namespace hausbench
