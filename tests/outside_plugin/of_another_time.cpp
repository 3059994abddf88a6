// A plug-in that was built against another version of hausbench.
extern "C" __attribute__((visibility("default"))) int hausbench_plugin_interface() { return 999; }
