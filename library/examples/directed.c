/* Prints an interval that contains h(A,B), the largest distance of a point of A to B (hausbench.h says how to build
   without installing the library):

       cc directed.c -o directed -lhausbench
       ./directed a.ply b.ply */
#include <hausbench.h>

#include <stdio.h>

/* Prints the error, if there is one, and returns whether all went well. */
static int is_well(int code, const hausbench_error* error) {
    if (code != HAUSBENCH_OK) fprintf(stderr, "%s\n", error->text);
    return code == HAUSBENCH_OK;
}

int main(int argument_count, char** arguments) {
    hausbench_shape *a = NULL, *b = NULL;
    hausbench_pair* pair = NULL;
    hausbench_query query = HAUSBENCH_QUERY_INIT;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    int done = 0;

    if (argument_count != 3) {
        fprintf(stderr, "usage: directed A B\n");
        return 2;
    }
    query.tolerance = 1e-6; /* of the diagonal of A's box */
    if (is_well(hausbench_read(arguments[1], &a, &error), &error) &&
        is_well(hausbench_read(arguments[2], &b, &error), &error) &&
        is_well(hausbench_prepare(a, b, NULL, &pair, &error), &error) &&
        is_well(hausbench_directed(pair, &query, &answer, &error), &error)) {
        printf("h(A,B) in [%.17g, %.17g]\n", answer.bounds.lower, answer.bounds.upper);
        printf("farthest point of A: %g %g %g\n", answer.source_point[0], answer.source_point[1],
               answer.source_point[2]);
        done = 1;
    }
    hausbench_pair_release(pair);
    hausbench_shape_release(b);
    hausbench_shape_release(a);
    return done ? 0 : 2;
}
