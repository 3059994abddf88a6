// What a plug-in looks like that was built against another hausbench.
extern "C" __attribute__((visibility("default"))) int hausbench_plugin_interface() { return 999; }
