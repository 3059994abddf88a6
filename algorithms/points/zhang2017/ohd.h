// Code shared by ohd.cpp and ohd_as_printed.cpp.
#pragma once

#include "algorithms/points/early_break.h"

#include <cmath>

namespace hausbench::zhang2017 {

// Returns a random sample of ceil(lambda * count) of the numbers 0 to count - 1, in random order.
inline std::vector<Index> first_of_order(Index count, double lambda, Generator& random) {
    std::vector<Index> order = order_of(count, true, random);
    order.resize(static_cast<std::size_t>(std::ceil(lambda * count)));
    return order;
}

inline std::vector<ParameterSpec> ohd_parameters() {
    return {
        {.name = "lambda",
         .default_value = 0.01,
         .unit = "of |A|",
         .paper_value = "1/100",
         .description = "outer loops of EARLYBREAK that give the first lower bound",
         .least = 0,
         .most = 1},
        seed_parameter(),
    };
}

}  // namespace hausbench::zhang2017
