"""Asks the server of a page, as the page does."""

import http.client
import json


def ask(page, path, question):
    place, token = page.address.removeprefix("http://").split("/#")
    connection = http.client.HTTPConnection(place, timeout=30)
    headers = {"X-Firsthit-Token": token, "Content-Type": "application/json"}
    connection.request("POST", path, json.dumps(question), headers)
    reply = connection.getresponse()
    content = reply.read()
    connection.close()
    assert reply.status == 200, content
    return content
