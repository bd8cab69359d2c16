/* Defs with their defaults, marked as initialised. */
#include "device.h"
#include <hitpipe/usb.h>

hp_device_def hp_default_device_def(void) {
    hp_device_def def = {
        .cookie = HP_DEVICE_COOKIE,
        .target = "model",
        .timeout_ms = 10000,
        .retries = 3,
        .usb_vendor = HP_USB_VENDOR,
        .usb_product = HP_USB_PRODUCT,
        .usb_depth = 4,
    };
    hp_config_preset(&def.board, "usb3");
    return def;
}

hp_query_def hp_default_query_def(void) {
    return (hp_query_def){
        .cookie = HP_QUERY_COOKIE,
        .pair = HP_PAIR_RAY_TRIANGLE,
        .mode = HP_MODE_CLOSEST,
    };
}
